#include "perception/glare/fraunhofer_mask_tables.h"

#include <algorithm>
#include <cmath>

namespace entoptic::perception {
namespace {

constexpr double pi = 3.14159265358979323846;

int zone_count(const FraunhoferMaskParams& p) { return std::max(static_cast<int>(std::lround(p.zones)), 1); }
bool lids_matter(const FraunhoferMaskParams& p) { return p.lids > 0.5f || p.lashes >= 0.5f; }

}  // namespace

double zone_angle_rad(int zone, int zones) { return zones < 2 ? 0 : (static_cast<double>(zone) / (zones - 1) - 0.5) * pi / 2; }

MaskKey mask_key(const FraunhoferMaskParams& p, double pupil_mm, double eyelid_open) {
    const double lid = std::clamp(eyelid_open * static_cast<double>(p.lid_open), 0.0, 1.0);
    return {std::max(std::lround(pupil_mm / static_cast<double>(p.pupil_step_mm)), 1l), lids_matter(p) ? std::lround(lid * static_cast<double>(p.lid_steps)) : 0};
}

std::shared_ptr<const MaskTables> make_mask_tables(const FraunhoferMaskParams& params, const MaskPicture* picture, MaskKey key) {
    FraunhoferMaskParams p = params;
    p.lid_open = 1;        // the key has it
    const double pupil_mm = static_cast<double>(key.pupil) * static_cast<double>(p.pupil_step_mm);
    const double open = lids_matter(p) ? static_cast<double>(key.lid) / static_cast<double>(p.lid_steps) : 1;
    auto made = std::make_shared<MaskTables>();
    const int zones = zone_count(p);
    for (int zone = 0; zone < zones; ++zone) {
        // Light from the right passes the obstacles farther right: they seem to stand to the left (facts 3.3, trap K4).
        const double shift = -static_cast<double>(p.obstacle_mm) * std::tan(zone_angle_rad(zone, zones));
        const ApertureRaster aperture = raster_aperture(p, picture, {pupil_mm, open, shift}, mask_samples, mask_plane_over_pupil * pupil_mm);
        made->zones.push_back(make_mask_table(make_psf(aperture), diffracted_spectrum(p)));
    }
    return made;
}

void MaskTableMaker::configure(const FraunhoferMaskParams& params, std::shared_ptr<const MaskPicture> picture) {
    const std::lock_guard lock(mutex_);
    params_ = params;
    picture_ = std::move(picture);
    kept_.clear();
    wanted_.reset();
    ++generation_;
}

std::shared_ptr<const MaskTables> MaskTableMaker::kept(MaskKey key) {
    const auto found = std::find_if(kept_.begin(), kept_.end(), [&](const Kept& k) { return k.first == key; });
    if (found == kept_.end()) return nullptr;
    std::rotate(found, found + 1, kept_.end());
    return kept_.back().second;
}

std::shared_ptr<const MaskTables> MaskTableMaker::tables(MaskKey key, bool wait) {
    std::unique_lock lock(mutex_);
    if (auto found = kept(key)) return found;
    if (!thread_.joinable()) thread_ = std::jthread([this](const std::stop_token& stop) { work(stop); });
    wanted_ = key;
    changed_.notify_all();
    std::shared_ptr<const MaskTables> found;
    if (wait) changed_.wait(lock, [&] { return (found = kept(key)) != nullptr; });
    return found;
}

void MaskTableMaker::work(const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    while (changed_.wait(lock, stop, [&] { return wanted_.has_value(); })) {
        const MaskKey key = *std::exchange(wanted_, std::nullopt);
        const FraunhoferMaskParams params = params_;
        const std::shared_ptr<const MaskPicture> picture = picture_;
        const std::uint64_t generation = generation_;
        lock.unlock();
        auto made = make_mask_tables(params, picture.get(), key);
        lock.lock();
        if (generation != generation_) continue;
        kept_.emplace_back(key, std::move(made));
        if (kept_.size() > std::max<std::size_t>(most_kept / static_cast<std::size_t>(zone_count(params_)), 2)) kept_.pop_front();
        changed_.notify_all();
    }
}

}  // namespace entoptic::perception
