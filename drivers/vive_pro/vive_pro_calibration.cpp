#include "drivers/vive_pro/vive_pro_calibration.h"

#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <zlib.h>

namespace entoptic::drivers::vive_pro {

namespace {

using Json = nlohmann::json;

// ---- Reading with the path of what is wrong ------------------------------------------------------------------------------------------

class Node {
public:
    Node(const Json& json, std::string path) : json_(&json), path_(std::move(path)) {}

    const std::string& path() const { return path_; }
    bool has(const char* key) const { return json_->is_object() && json_->contains(key); }
    Result<Node> at(const char* key) const {
        if (!has(key)) return failure(fmt::format("The headset's configuration has no '{}{}'.", prefix(), key));
        return Node((*json_)[key], prefix() + key);
    }
    Result<Node> at(std::size_t index) const {
        if (!json_->is_array() || json_->size() <= index)
            return failure(fmt::format("The headset's configuration: '{}' should be a list of at least {}.", path_, index + 1));
        return Node((*json_)[index], fmt::format("{}[{}]", path_, index));
    }
    std::size_t size() const { return json_->is_array() ? json_->size() : 0; }
    Result<double> number(double low, double high) const {
        const double value = json_->is_number() ? json_->get<double>() : std::nan("");
        if (!(value >= low && value <= high))
            return failure(fmt::format("The headset's configuration: '{}' should be a number from {:g} to {:g}.", path_, low, high));
        return value;
    }
    std::string text() const { return json_->is_string() ? json_->get<std::string>().substr(0, 64) : std::string(); }

private:
    std::string prefix() const { return path_.empty() ? "" : path_ + "."; }

    const Json* json_;
    std::string path_;
};

Result<double> number(const Node& node, const char* key, double low, double high) {
    ENTOPTIC_TRY(value, node.at(key));
    return value.number(low, high);
}
Result<double> number_or(const Node& node, const char* key, double low, double high, double fallback) {
    return node.has(key) ? number(node, key, low, high) : Result<double>(fallback);
}
Result<glm::dvec3> vector(const Node& node, const char* key, double limit) {
    ENTOPTIC_TRY(list, node.at(key));
    glm::dvec3 out;
    for (std::size_t i = 0; i < 3; ++i) {
        ENTOPTIC_TRY(element, list.at(i));
        ENTOPTIC_TRY(value, element.number(-limit, limit));
        out[static_cast<int>(i)] = value;
    }
    return out;
}
Result<glm::dvec3> unit_vector(const Node& node, const char* key) {
    ENTOPTIC_TRY(v, vector(node, key, 2));
    const double length = glm::length(v);
    if (!(length > 0.9 && length < 1.1)) return failure(fmt::format("The headset's configuration: '{}.{}' should be a unit vector.", node.path(), key));
    return v / length;
}
std::string text(const Node& node, const char* key) {
    const auto value = node.at(key);
    return value ? value->text() : std::string();
}

// ---- Poses in both generations' forms ---------------------------------------------------------------------------------------------------

struct Frame {
    glm::dmat3 rotation{1};   // trackref from this frame
    glm::dvec3 position{0};   // of its origin in trackref, m
};

// {plus_x, plus_z, position}: the frame's own axes in trackref.
Result<Frame> axes_frame(const Node& node) {
    ENTOPTIC_TRY(x, unit_vector(node, "plus_x"));
    ENTOPTIC_TRY(z, unit_vector(node, "plus_z"));
    ENTOPTIC_TRY(position, vector(node, "position", 1));
    if (std::abs(glm::dot(x, z)) > 1e-2) return failure(fmt::format("The headset's configuration: '{}': plus_x and plus_z should be at right angles.", node.path()));
    const glm::dvec3 y = glm::normalize(glm::cross(z, x));
    return Frame{glm::dmat3(glm::cross(y, z), y, z), position};
}

// [qx, qy, qz, qw, px, py, pz]
Result<Frame> quaternion_frame(const Node& root, const char* key) {
    ENTOPTIC_TRY(list, root.at(key));
    std::array<double, 7> n{};
    for (std::size_t i = 0; i < n.size(); ++i) {
        ENTOPTIC_TRY(element, list.at(i));
        ENTOPTIC_TRY(value, element.number(-2, 2));
        n[i] = value;
    }
    const glm::dquat q(n[3], n[0], n[1], n[2]);
    const double length = glm::length(q);
    if (!(length > 0.9 && length < 1.1)) return failure(fmt::format("The headset's configuration: the first four numbers of '{}' should be a unit quaternion.", key));
    return Frame{glm::mat3_cast(q / length), {n[4], n[5], n[6]}};
}

struct Frames {
    Frame head, imu;
};
Result<Frames> read_frames(const Node& root) {
    if (root.has("head")) {
        ENTOPTIC_TRY(head_node, root.at("head"));
        ENTOPTIC_TRY(imu_node, root.at("imu"));
        ENTOPTIC_TRY(head, axes_frame(head_node));
        ENTOPTIC_TRY(imu, axes_frame(imu_node));
        return Frames{head, imu};
    }
    ENTOPTIC_TRY(head, quaternion_frame(root, "trackref_from_head"));
    ENTOPTIC_TRY(imu, quaternion_frame(root, "trackref_from_imu"));
    // The Vive's file means an IMU with y up and z backward; its chip is mounted with y down and z forward (gravity in recorded reports).
    imu.rotation = imu.rotation * glm::dmat3({1, 0, 0}, {0, -1, 0}, {0, 0, -1});
    return Frames{head, imu};
}

Result<ImuCalibration> read_imu(const Node& root, const Frames& frames) {
    Node node = root;
    if (root.has("imu")) {
        ENTOPTIC_TRY(imu, root.at("imu"));
        node = imu;
    }
    ImuCalibration out;
    ENTOPTIC_TRY(acceleration_scale, vector(node, "acc_scale", 2));
    ENTOPTIC_TRY(acceleration_bias, vector(node, "acc_bias", 5));
    ENTOPTIC_TRY(rate_scale, vector(node, "gyro_scale", 2));
    ENTOPTIC_TRY(rate_bias, vector(node, "gyro_bias", 2));
    out.acceleration_scale = acceleration_scale;
    out.acceleration_bias = acceleration_bias;
    out.angular_rate_scale = rate_scale;
    out.angular_rate_bias = rate_bias;
    const glm::dmat3 head_from_trackref = glm::transpose(frames.head.rotation);
    out.head_from_imu = head_from_trackref * frames.imu.rotation;
    out.position_in_head = head_from_trackref * (frames.imu.position - frames.head.position);
    return out;
}

// ---- Lenses -------------------------------------------------------------------------------------------------------------------------------

Result<ChannelDistortion> read_channel(const Node& eye, const char* key) {
    ENTOPTIC_TRY(node, eye.at(key));
    if (const std::string type = text(node, "type"); type != "DISTORT_DPOLY3")
        return failure(fmt::format("The headset's configuration: '{}' is of type '{}'; only DISTORT_DPOLY3 is known.", node.path(), type));
    ChannelDistortion out;
    ENTOPTIC_TRY(x, number(node, "center_x", -1, 1));
    ENTOPTIC_TRY(y, number(node, "center_y", -1, 1));
    ENTOPTIC_TRY(coefficients, vector(node, "coeffs", 10));
    out.centre = {x, y};
    out.coefficients = coefficients;
    return out;
}

Result<double> intrinsic(const Node& eye, std::size_t row, std::size_t column, double low, double high) {
    ENTOPTIC_TRY(matrix, eye.at("intrinsics"));
    ENTOPTIC_TRY(line, matrix.at(row));
    ENTOPTIC_TRY(element, line.at(column));
    return element.number(low, high);
}

Result<Lens> read_lens(const Node& eye, double aspect) {
    Lens lens;
    ENTOPTIC_TRY(red, read_channel(eye, "distortion_red"));
    ENTOPTIC_TRY(green, read_channel(eye, "distortion"));
    ENTOPTIC_TRY(blue, read_channel(eye, "distortion_blue"));
    ENTOPTIC_TRY(grow, number(eye, "grow_for_undistort", 0, 2));
    ENTOPTIC_TRY(cutoff, number(eye, "undistort_r2_cutoff", 0.1, 10));
    ENTOPTIC_TRY(fx, intrinsic(eye, 0, 0, 0.3, 5));
    ENTOPTIC_TRY(fy, intrinsic(eye, 1, 1, 0.3, 5));
    ENTOPTIC_TRY(cx, intrinsic(eye, 0, 2, -1, 1));
    ENTOPTIC_TRY(cy, intrinsic(eye, 1, 2, -1, 1));
    lens.channels = {red, green, blue};
    lens.aspect = static_cast<float>(aspect);
    lens.grow_for_undistort = static_cast<float>(grow);
    lens.r2_cutoff = static_cast<float>(cutoff);
    lens.focal = {fx, fy};
    lens.principal_point = {cx, cy};
    return lens;
}

Result<void> read_display(const Node& root, Calibration& out) {
    ENTOPTIC_TRY(device, root.at("device"));
    ENTOPTIC_TRY(width, number(device, "eye_target_width_in_pixels", 16, 8192));
    ENTOPTIC_TRY(height, number(device, "eye_target_height_in_pixels", 16, 8192));
    ENTOPTIC_TRY(aspect, number(device, "physical_aspect_x_over_y", 0.3, 3));
    ENTOPTIC_TRY(persistence, number_or(device, "persistence", 0, 0.1, 0));
    ENTOPTIC_TRY(photons, number_or(root, "seconds_from_vsync_to_photons", -0.1, 0.1, 0));
    ENTOPTIC_TRY(separation, number(root, "lens_separation", 0.05, 0.08));
    ENTOPTIC_TRY(eyes, root.at("tracking_to_eye_transform"));
    out.panel_width = static_cast<int>(width);
    out.panel_height = static_cast<int>(height);
    out.persistence_s = persistence;
    out.vsync_to_photons_s = photons;
    out.lens_separation_m = separation;
    for (std::size_t side = 0; side < 2; ++side) {
        ENTOPTIC_TRY(eye, eyes.at(side));
        ENTOPTIC_TRY(lens, read_lens(eye, aspect));
        out.lenses[side] = lens;
    }
    return {};
}

// ---- Lighthouse sensors ---------------------------------------------------------------------------------------------------------------

Result<glm::dvec3> point(const Node& list, std::size_t index, double limit) {
    ENTOPTIC_TRY(node, list.at(index));
    glm::dvec3 out;
    for (std::size_t i = 0; i < 3; ++i) {
        ENTOPTIC_TRY(element, node.at(i));
        ENTOPTIC_TRY(value, element.number(-limit, limit));
        out[static_cast<int>(i)] = value;
    }
    return out;
}

Result<void> read_sensors(const Node& root, const Frame& head, Calibration& out) {
    out.channel_map.fill(-1);
    if (!root.has("lighthouse_config")) return {};
    ENTOPTIC_TRY(config, root.at("lighthouse_config"));
    ENTOPTIC_TRY(channels, config.at("channelMap"));
    ENTOPTIC_TRY(points, config.at("modelPoints"));
    ENTOPTIC_TRY(normals, config.at("modelNormals"));
    const std::size_t count = points.size();
    if (count > 32 || normals.size() != count || channels.size() > count)
        return failure(fmt::format("The headset's configuration: lighthouse_config has {} channels, {} points and {} normals.", channels.size(), count, normals.size()));
    const glm::dmat3 head_from_trackref = glm::transpose(head.rotation);
    for (std::size_t i = 0; i < count; ++i) {
        ENTOPTIC_TRY(position, point(points, i, 1));
        ENTOPTIC_TRY(normal, point(normals, i, 1.1));
        out.sensors.push_back({head_from_trackref * (position - head.position), head_from_trackref * glm::normalize(normal + glm::dvec3(0, 0, 1e-12))});
    }
    for (std::size_t i = 0; i < channels.size(); ++i) {
        ENTOPTIC_TRY(element, channels.at(i));
        ENTOPTIC_TRY(channel, element.number(0, 31));
        out.channel_map[static_cast<std::size_t>(channel)] = static_cast<int>(i);
    }
    return {};
}

// Integers of the newer files; the vendor's two bytes are swapped there.
Result<void> read_edid(const Node& root, Calibration& out) {
    if (!root.has("direct_mode_edid_vid") || !root.has("direct_mode_edid_pid")) return {};
    ENTOPTIC_TRY(vendor, number(root, "direct_mode_edid_vid", 0, 0xffff));
    ENTOPTIC_TRY(product, number(root, "direct_mode_edid_pid", 0, 0xffff));
    const auto swapped = static_cast<std::uint16_t>(vendor);
    out.edid_vendor = static_cast<std::uint16_t>(swapped << 8 | swapped >> 8);
    out.edid_product = static_cast<std::uint16_t>(product);
    return {};
}

glm::dvec3 counts(const std::array<std::int16_t, 3>& c) { return {c[0], c[1], c[2]}; }

}  // namespace

glm::dvec3 ImuCalibration::acceleration(const ImuSample& sample, const ImuRanges& ranges) const {
    return head_from_imu * (acceleration_scale * counts(sample.acceleration) * (ranges.acceleration / 32768) - acceleration_bias);
}
glm::dvec3 ImuCalibration::angular_rate(const ImuSample& sample, const ImuRanges& ranges) const {
    return head_from_imu * (angular_rate_scale * counts(sample.angular_rate) * (ranges.angular_rate / 32768) - angular_rate_bias);
}

Result<std::string> inflate_configuration(Bytes compressed) {
    if (compressed.size() > max_compressed_bytes)
        return failure(fmt::format("The headset's configuration has {} bytes compressed; at most {} are expected.", compressed.size(), max_compressed_bytes));
    std::string text(max_configuration_bytes, '\0');
    z_stream stream{};
    stream.next_in = const_cast<Bytef*>(compressed.data());
    stream.avail_in = static_cast<uInt>(compressed.size());
    stream.next_out = reinterpret_cast<Bytef*>(text.data());
    stream.avail_out = static_cast<uInt>(text.size());
    if (inflateInit(&stream) != Z_OK) return failure("zlib could not be started: out of memory.");
    const int outcome = inflate(&stream, Z_FINISH);
    const std::size_t written = stream.total_out;
    inflateEnd(&stream);
    if (outcome != Z_STREAM_END)
        return failure(fmt::format("The headset's configuration cannot be unpacked ({} of {} bytes read, {} written): it came damaged, or cut short. "
                                   "Unplug the headset and plug it in again.", stream.total_in, compressed.size(), written));
    text.resize(written);
    return text;
}

Result<Calibration> parse_calibration(const std::string& json) {
    const Json document = Json::parse(json, nullptr, false);
    if (!document.is_object()) return failure("The headset's configuration is not a JSON object.");
    const Node root(document, "");
    Calibration out;
    out.model = text(root, "model_number");
    out.serial = text(root, "device_serial_number");
    out.mainboard_serial = text(root, "mb_serial_number");
    out.is_headset = text(root, "device_class") == "hmd";
    if (!out.is_headset) return out;   // a tracker's file has nothing else that counts here
    ENTOPTIC_TRY(frames, read_frames(root));
    ENTOPTIC_TRY(imu, read_imu(root, frames));
    out.imu = imu;
    ENTOPTIC_CHECK(read_display(root, out));
    ENTOPTIC_CHECK(read_sensors(root, frames.head, out));
    ENTOPTIC_CHECK(read_edid(root, out));
    return out;
}

}  // namespace entoptic::drivers::vive_pro
