#include "drivers/recording/recorded_samples.h"

#include <bit>

namespace entoptic::drivers {

namespace {

class Out {
public:
    void u64(std::uint64_t value) {
        for (int i = 0; i < 8; ++i) bytes_.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
    }
    void u32(std::uint32_t value) {
        for (int i = 0; i < 4; ++i) bytes_.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
    }
    void u16(std::uint16_t value) {
        for (int i = 0; i < 2; ++i) bytes_.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
    }
    void bytes(std::span<const std::uint8_t> given) { bytes_.insert(bytes_.end(), given.begin(), given.end()); }
    void number(float value) { u32(std::bit_cast<std::uint32_t>(value)); }
    void vector(glm::vec3 v) {
        number(v.x);
        number(v.y);
        number(v.z);
    }
    Payload take() { return std::move(bytes_); }

private:
    Payload bytes_;
};

class In {
public:
    explicit In(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}
    std::uint64_t u64() { return get(8); }
    std::uint32_t u32() { return static_cast<std::uint32_t>(get(4)); }
    std::uint16_t u16() { return static_cast<std::uint16_t>(get(2)); }
    std::span<const std::uint8_t> rest() const { return bytes_.subspan(at_); }
    float number() { return std::bit_cast<float>(u32()); }
    glm::vec3 vector() {
        const float x = number(), y = number(), z = number();
        return {x, y, z};
    }

private:
    std::uint64_t get(int bytes) {
        std::uint64_t value = 0;
        for (int i = 0; i < bytes; ++i) value |= static_cast<std::uint64_t>(bytes_[at_++]) << (8 * i);
        return value;
    }
    std::span<const std::uint8_t> bytes_;
    std::size_t at_ = 0;
};

constexpr std::size_t pose_bytes = 8 + 13 * 4 + 4, eye_bytes = 4 + 8 + 8 + 5 * 4;
constexpr std::uint32_t orientation_valid = 1, position_valid = 2, orientation_tracked = 4, position_tracked = 8, velocity_valid = 16;

}  // namespace

Payload encode_pose(TimeNs time, const PoseState& s) {
    Out out;
    out.u64(static_cast<std::uint64_t>(time));
    out.vector(s.pose.position);
    for (const float q : {s.pose.orientation.x, s.pose.orientation.y, s.pose.orientation.z, s.pose.orientation.w}) out.number(q);
    out.vector(s.linear_velocity);
    out.vector(s.angular_velocity);
    out.u32((s.orientation_valid ? orientation_valid : 0) | (s.position_valid ? position_valid : 0) |
            (s.orientation_tracked ? orientation_tracked : 0) | (s.position_tracked ? position_tracked : 0) |
            (s.velocity_valid ? velocity_valid : 0));
    return out.take();
}

std::optional<RecordedPose> decode_pose(std::span<const std::uint8_t> payload) {
    if (payload.size() != pose_bytes) return std::nullopt;
    In in(payload);
    RecordedPose out;
    out.time = static_cast<TimeNs>(in.u64());
    out.state.pose.position = in.vector();
    const float x = in.number(), y = in.number(), z = in.number(), w = in.number();
    const glm::quat q(w, x, y, z);
    const float length = glm::length(q);
    if (!(length > 0.9f && length < 1.1f)) return std::nullopt;
    out.state.pose.orientation = q;
    out.state.linear_velocity = in.vector();
    out.state.angular_velocity = in.vector();
    const glm::vec3& p = out.state.pose.position;
    for (const float number : {p.x, p.y, p.z, out.state.linear_velocity.x, out.state.linear_velocity.y, out.state.linear_velocity.z,
                               out.state.angular_velocity.x, out.state.angular_velocity.y, out.state.angular_velocity.z})
        if (!(number > -1e6f && number < 1e6f)) return std::nullopt;
    const std::uint32_t flags = in.u32();
    out.state.orientation_valid = flags & orientation_valid;
    out.state.position_valid = flags & position_valid;
    out.state.orientation_tracked = flags & orientation_tracked;
    out.state.position_tracked = flags & position_tracked;
    out.state.velocity_valid = flags & velocity_valid;
    return out;
}

Payload encode_eye(int eye, const RawEyeSample& s) {
    Out out;
    out.u32(static_cast<std::uint32_t>(eye));
    out.u64(static_cast<std::uint64_t>(s.time));
    out.u64(static_cast<std::uint64_t>(s.arrival));
    out.vector(s.gaze_direction);
    out.number(s.pupil_diameter_mm);
    out.number(s.confidence);
    return out.take();
}

std::optional<RecordedEye> decode_eye(std::span<const std::uint8_t> payload) {
    if (payload.size() != eye_bytes) return std::nullopt;
    In in(payload);
    RecordedEye out;
    const std::uint32_t eye = in.u32();
    if (eye > 1) return std::nullopt;
    out.eye = static_cast<int>(eye);
    out.sample.time = static_cast<TimeNs>(in.u64());
    out.sample.arrival = static_cast<TimeNs>(in.u64());
    out.sample.gaze_direction = in.vector();
    out.sample.pupil_diameter_mm = in.number();
    out.sample.confidence = in.number();
    return out;
}

// eye, time, sequence, width, height, length of the name, name, picture.
constexpr std::size_t picture_head_bytes = 4 + 8 + 4 + 2 + 2 + 2, longest_product = 255;

Payload encode_eye_picture(const EyePicture& picture) {
    Out out;
    out.u32(static_cast<std::uint32_t>(picture.eye));
    out.u64(static_cast<std::uint64_t>(picture.time));
    out.u32(picture.sequence);
    out.u16(static_cast<std::uint16_t>(picture.width));
    out.u16(static_cast<std::uint16_t>(picture.height));
    const std::string name = picture.product.substr(0, longest_product);
    out.u16(static_cast<std::uint16_t>(name.size()));
    out.bytes({reinterpret_cast<const std::uint8_t*>(name.data()), name.size()});
    out.bytes(picture.jpeg);
    return out.take();
}

std::optional<EyePicture> decode_eye_picture(std::span<const std::uint8_t> payload) {
    if (payload.size() < picture_head_bytes) return std::nullopt;
    In in(payload);
    EyePicture out;
    const std::uint32_t eye = in.u32();
    out.eye = static_cast<int>(eye);
    out.time = static_cast<TimeNs>(in.u64());
    out.sequence = in.u32();
    out.width = in.u16();
    out.height = in.u16();
    const std::size_t name = in.u16();
    const auto rest = in.rest();
    if (eye > 1 || out.width == 0 || out.height == 0 || name > longest_product || name > rest.size()) return std::nullopt;
    out.product.assign(rest.begin(), rest.begin() + static_cast<std::ptrdiff_t>(name));
    out.jpeg.assign(rest.begin() + static_cast<std::ptrdiff_t>(name), rest.end());
    return out;
}

}  // namespace entoptic::drivers
