// Tables of diffracted light by the state of the eye, made by a thread of their own and kept: frames need not wait.
#pragma once

#include "perception/glare/fraunhofer_mask_psf.h"

#include <compare>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

namespace entoptic::perception {

// Transforms are of this many samples a side: light of 550 nm through a pupil of 5 mm is known up to 2.6 degrees, 36 pixels of 13.85 a degree.
// Of 1024 it is to 18 pixels, and the law that carries streaks on from there can be seen in half-closed lashes (p99 dE_ITP 4.8, of 2048 0.7).
constexpr int mask_samples = 2048;
// The plane is wider than the pupil by this, so that light averaged over a pixel does not wrap around: lambda / pixel is 0.4 mm.
constexpr double mask_plane_over_pupil = 1.25;

// One table a zone of the view.
struct MaskTables {
    std::vector<std::vector<vec3>> zones;
};

// Steps of pupil diameter and lid opening.
struct MaskKey {
    long pupil = 0, lid = 0;
    auto operator<=>(const MaskKey&) const = default;
};

// Middle of a zone's light: its horizontal angle to the right, rad; see zone_place() in glare_math.glsl.
double zone_angle_rad(int zone, int zones);
MaskKey mask_key(const FraunhoferMaskParams& params, double pupil_mm, double eyelid_open);
std::shared_ptr<const MaskTables> make_mask_tables(const FraunhoferMaskParams& params, const MaskPicture* picture, MaskKey key);

class MaskTableMaker {
public:
    // Forgets what there was. `picture` may be null.
    void configure(const FraunhoferMaskParams& params, std::shared_ptr<const MaskPicture> picture);
    // Null while it is being made, unless `wait`. Only what was asked for last is made.
    std::shared_ptr<const MaskTables> tables(MaskKey key, bool wait);

private:
    using Kept = std::pair<MaskKey, std::shared_ptr<const MaskTables>>;
    void work(const std::stop_token& stop);
    std::shared_ptr<const MaskTables> kept(MaskKey key);

    static constexpr std::size_t most_kept = 20;    // tables, 8.4 MB each and zone
    std::mutex mutex_;
    std::condition_variable_any changed_;
    FraunhoferMaskParams params_{};
    std::shared_ptr<const MaskPicture> picture_;
    std::optional<MaskKey> wanted_;
    std::deque<Kept> kept_;                         // used last stands last
    std::uint64_t generation_ = 0;                  // of configure()
    std::jthread thread_;                           // last: stops before the rest goes
};

}  // namespace entoptic::perception
