#include "perception/stage.h"

#include "base/log.h"
#include "perception/foveation/foveation.h"
#include "perception/gate.h"
#include "perception/observer_state.h"

#include "perception/ingest.comp.h"
#include "perception/solid_angle.comp.h"
#include "perception/statistics.comp.h"
#include "perception/tiles.comp.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <fmt/format.h>

namespace entoptic::perception {
namespace {

using gpu::BindingKind;

struct StatisticsPush {
    uint tile_count;
    float black_cd_m2;
};
struct SizePush {
    uint width, height;
};

float dioptre_of_metres(float metres) { return metres > 0 ? std::min(1 / metres, max_dioptre) : unknown_dioptre; }

std::string label(const Choice& choice) { return fmt::format("perceive.{}", choice.entry->slot); }

}  // namespace

Result<std::unique_ptr<Stage>> Stage::create(gpu::Device& device, const StageOptions& options) {
    std::unique_ptr<Stage> stage(new Stage(device));
    ENTOPTIC_CHECK(stage->allocate(options));
    ENTOPTIC_CHECK(stage->select(options.selection));
    return stage;
}

Stage::Stage(gpu::Device& device) : device_(device) {}

Stage::~Stage() = default;

Result<void> Stage::allocate(const StageOptions& options) {
    if (options.views.empty() || options.views[0].width == 0 || options.views[0].height == 0)
        return failure("The perception stage needs at least one view of at least one pixel.");
    for (const EyeGeometry& view : options.views)
        if (view.width != options.views[0].width || view.height != options.views[0].height)
            return failure(fmt::format("All views must be of one size, but one has {}x{} pixels and one {}x{}.", options.views[0].width,
                                       options.views[0].height, view.width, view.height));
    width_ = options.views[0].width;
    height_ = options.views[0].height;
    views_ = static_cast<std::uint32_t>(options.views.size());
    context_.views = options.views;
    context_.display = options.display;
    context_.seed = options.seed;
    context_.repeatable = options.repeatable;
    context_.full_views = options.full_views;
    const auto buffer = [&](gpu::Buffer& into, std::size_t bytes, gpu::BufferKind kind, const char* name) -> Result<void> {
        ENTOPTIC_TRY(made, gpu::Buffer::create(device_, bytes, kind, name));
        into = std::move(made);
        return {};
    };
    const std::size_t tile_bytes = std::size_t(tiles_x()) * tiles_y() * views_ * sizeof(TileStatistics);
    ENTOPTIC_CHECK(buffer(scene_, view_bytes() * views_, gpu::BufferKind::device, "scene"));
    ENTOPTIC_CHECK(buffer(tiles_, tile_bytes, gpu::BufferKind::device, "tiles"));
    ENTOPTIC_CHECK(buffer(geometry_, sizeof(EyeGeometry) * views_, gpu::BufferKind::upload, "geometry"));
    ENTOPTIC_CHECK(buffer(statistics_, sizeof(SceneStatistics) * views_, gpu::BufferKind::device, "statistics"));
    ENTOPTIC_CHECK(buffer(statistics_readback_, sizeof(SceneStatistics) * views_, gpu::BufferKind::readback, "statistics readback"));
    // Small, written once by the CPU and read back every frame: one host-visible buffer does both.
    ENTOPTIC_CHECK(buffer(state_, sizeof(ObserverState) * views_, gpu::BufferKind::upload, "observer state"));
    ENTOPTIC_CHECK(buffer(state_readback_, sizeof(ObserverState) * views_, gpu::BufferKind::readback, "observer state readback"));
    std::memcpy(geometry_.bytes().data(), options.views.data(), geometry_.size());
    for (ObserverState& state : state_.as<ObserverState>()) state = fresh_state();
    std::memset(state_readback_.bytes().data(), 0, state_readback_.size());
    std::memset(statistics_readback_.bytes().data(), 0, statistics_readback_.size());
    downloads_.resize(views_);

    ENTOPTIC_CHECK(buffer(solid_angle_, view_bytes() / 4 * views_, gpu::BufferKind::device, "solid angles"));
    ENTOPTIC_CHECK(create_kernels());
    return fill_solid_angles();
}

Result<void> Stage::create_kernels() {
    const auto storage = BindingKind::storage_buffer;
    ENTOPTIC_TRY(ingest, gpu::Kernel::create(device_, {"ingest", ingest_comp_spv, {storage, storage, storage}, sizeof(SizePush), {}}));
    ingest_ = std::move(ingest);
    ENTOPTIC_TRY(tiles, gpu::Kernel::create(device_, {"tiles", tiles_comp_spv, {storage, storage, storage}, sizeof(SizePush), {}}));
    tiles_kernel_ = std::move(tiles);
    ENTOPTIC_TRY(statistics, gpu::Kernel::create(device_, {"statistics", statistics_comp_spv, {storage, storage}, sizeof(StatisticsPush), {}}));
    statistics_kernel_ = std::move(statistics);
    return {};
}

Result<void> Stage::fill_solid_angles() {
    const auto storage = BindingKind::storage_buffer;
    ENTOPTIC_TRY(kernel, gpu::Kernel::create(device_, {"solid angles", solid_angle_comp_spv, {storage, storage}, 0, {}}));
    ENTOPTIC_TRY(commands, gpu::Commands::create(device_, "solid angles"));
    ENTOPTIC_CHECK(commands.begin());
    commands.dispatch(kernel, {geometry_, solid_angle_}, gpu::NoPush{}, {gpu::groups_for(width_, 32), gpu::groups_for(height_, 8), views_});
    ENTOPTIC_CHECK(commands.submit());
    return commands.wait();
}

Result<Stage::Slot> Stage::make_slot(const Choice& choice) {
    Slot slot;
    slot.choice = choice;
    ENTOPTIC_TRY(gate, gpu::Buffer::create(device_, sizeof(Gate), gpu::BufferKind::upload, fmt::format("gate {}", choice.entry->slot)));
    ENTOPTIC_TRY(readback, gpu::Buffer::create(device_, sizeof(Gate), gpu::BufferKind::readback, fmt::format("gate readback {}", choice.entry->slot)));
    std::memset(gate.bytes().data(), 0, gate.size());
    std::memset(readback.bytes().data(), 0, readback.size());
    slot.gate = std::move(gate);
    slot.gate_readback = std::move(readback);
    auto model = choice.entry->create(context_);
    const auto files = model ? (*model)->set_files(choice.files) : Result<void>{};
    if (!files) model = tl::unexpected(files.error());
    if (model) {
        slot.model = std::move(*model);
        slot.model->set_parameters(choice.parameters);
    } else {
        // One model that cannot start must not take the picture away: it is switched off and the user told.
        slot.failed = model.error().message;
        log::error("The model {} is switched off: {}", choice.entry->name, slot.failed);
    }
    return slot;
}

Result<void> Stage::select(const Selection& selection) {
    ENTOPTIC_CHECK(select_models(selection));
    return select_foveation();
}

// One stage cannot hold pictures of two sizes: the foveated image has a stage of its own.
Result<void> Stage::select_foveation() {
    if (selection_.foveation.inverse == FoveationInverse::off || (foveation_ && foveation_->settings() != selection_.foveation)) {
        if (foveation_) log::info("Foveation changes: the states of the eyes start anew.");
        foveation_.reset();
        foveated_ = false;
    }
    if (selection_.foveation.inverse == FoveationInverse::off) return {};
    if (foveation_) return foveation_->select(selection_);
    ENTOPTIC_TRY(made, Foveation::create(device_, {context_.views, context_.display, selection_, context_.seed, context_.repeatable}));
    foveation_ = std::move(made);
    return {};
}

Result<void> Stage::select_models(const Selection& selection) {
    const auto kept_slot = [&](const Choice& choice) {
        return std::find_if(slots_.begin(), slots_.end(), [&](const Slot& s) { return s.model && s.choice.entry == choice.entry; });
    };
    // Files first: they may have gone since the selection was made, and then nothing changes.
    for (const Choice& choice : selection.choices)
        if (const auto kept = kept_slot(choice); kept != slots_.end() && kept->choice.files != choice.files)
            ENTOPTIC_CHECK(kept->model->set_files(choice.files));
    std::vector<Slot> next;
    for (const Choice& choice : selection.choices) {
        const auto kept = kept_slot(choice);
        if (kept != slots_.end()) {
            kept->model->set_parameters(choice.parameters);
            kept->choice = choice;
            next.push_back(std::move(*kept));
            continue;
        }
        ENTOPTIC_TRY(slot, make_slot(choice));
        next.push_back(std::move(slot));
    }
    slots_ = std::move(next);
    selection_ = selection;
    if (!wants_depth() || dioptre_) return {};
    ENTOPTIC_TRY(dioptre, gpu::Buffer::create(device_, view_bytes() / 4 * views_, gpu::BufferKind::device, "dioptres"));
    dioptre_ = std::move(dioptre);
    return {};
}

bool Stage::wants_depth() const {
    return std::any_of(slots_.begin(), slots_.end(), [](const Slot& slot) {
        return slot.failed.empty() && slot.model && dynamic_cast<NeedsDepth*>(slot.model.get()) && !slot.model->is_identity();
    });
}

Result<void> Stage::expect_size(const ImageF& image, int channels, const char* what) const {
    if (image.width == static_cast<int>(width_) && image.height == static_cast<int>(height_) && image.channels == channels) return {};
    return failure(fmt::format("A {} of {}x{} with {} channel(s) was expected, {}x{} with {} came.", what, width_, height_, channels, image.width,
                               image.height, image.channels));
}

Result<void> Stage::record_ingest(gpu::Commands& commands, std::span<const ImageF> images, std::span<const ImageF> depths) {
    const std::size_t pixels = std::size_t(width_) * height_, bytes = pixels * 3 * sizeof(float);
    if (images.size() != views_) return failure(fmt::format("The stage has {} views but {} pictures came.", views_, images.size()));
    if (!upload_) {
        ENTOPTIC_TRY(upload, gpu::Buffer::create(device_, bytes * views_, gpu::BufferKind::upload, "picture upload"));
        upload_ = std::move(upload);
    }
    for (std::uint32_t v = 0; v < views_; ++v) {
        const ImageF& image = images[v];
        ENTOPTIC_CHECK(expect_size(image, 3, "picture"));
        std::memcpy(upload_.bytes().data() + v * bytes, image.data.data(), bytes);
    }
    commands.begin_stage("ingest");
    commands.dispatch(ingest_, {upload_, solid_angle_, scene_}, SizePush{width_, height_}, {gpu::groups_for(width_, 32), gpu::groups_for(height_, 8), views_});
    if (!depths.empty() && wants_depth()) ENTOPTIC_CHECK(record_depth(commands, depths));
    commands.barrier();
    commands.end_stage();
    return {};
}

Result<void> Stage::record_depth(gpu::Commands& commands, std::span<const ImageF> depths) {
    const std::size_t pixels = std::size_t(width_) * height_;
    if (depths.size() != views_) return failure(fmt::format("The stage has {} views but {} depths came.", views_, depths.size()));
    if (!depth_upload_) {
        ENTOPTIC_TRY(upload, gpu::Buffer::create(device_, dioptre_.size(), gpu::BufferKind::upload, "depth upload"));
        depth_upload_ = std::move(upload);
    }
    for (std::uint32_t v = 0; v < views_; ++v) {
        const ImageF& depth = depths[v];
        ENTOPTIC_CHECK(expect_size(depth, 1, "depth"));
        std::ranges::transform(depth.data, depth_upload_.as<float>().begin() + static_cast<std::ptrdiff_t>(v * pixels), dioptre_of_metres);
    }
    commands.copy(depth_upload_, dioptre_, dioptre_.size());
    depth_written();
    return {};
}

void Stage::set_adaptation(float cd_m2) {
    for (ObserverState& state : state_.as<ObserverState>()) {
        state = fresh_state();
        state.adaptation_cd_m2 = state.target_cd_m2 = cd_m2;
        state.initialised = 1;
    }
}

// Without a tone model the panel shows what it can, as it is.
ObserverState Stage::fresh_state() const {
    ObserverState state{};
    state.tone.exposure = 1;
    state.tone.straight_until_cd_m2 = state.tone.scene_white_cd_m2 = context_.display.white_cd_m2;
    for (uint i = 0; i < tone_points; ++i)
        state.tone.log10_displayed[i] = std::min(static_cast<float>(i) / tone_points_per_decade - 6, std::log10(context_.display.white_cd_m2));
    return state;
}

// Records one part of a slot's model, if it has that part.
template <class Part>
void Stage::record_part(Slot& slot, const char* suffix, Result<void> (Part::*part)(StageIo&), gpu::Commands& commands, const FrameInput& input) {
    auto* model = dynamic_cast<Part*>(slot.model.get());
    if (!model || !slot.failed.empty() || slot.model->is_identity()) return;
    StageIo io{commands, scene_, geometry_, solid_angle_, tiles_, statistics_, state_, slot.gate, width_, height_, views_, tiles_x(), tiles_y(), context_.display, input,
               has_depth_ ? &dioptre_ : nullptr};
    commands.begin_stage(label(slot.choice) + suffix);
    const auto recorded = (model->*part)(io);
    commands.barrier();
    commands.end_stage();
    slot.recorded = static_cast<bool>(recorded);
    if (recorded) return;
    slot.failed = recorded.error().message;
    log::error("The model {} is switched off: {}", slot.choice.entry->name, slot.failed);
}

// The mean that the panel showed: of the histogram's tiles through the tone curve, so that a lamp counts as much as the panel can show of it.
SceneFeedback Stage::feedback(std::uint32_t view) const {
    const SceneStatistics& s = statistics_readback_.as<SceneStatistics>()[view];
    const ToneCurve& tone = state_readback_.as<ObserverState>()[view].tone;
    SceneFeedback f{static_cast<double>(s.mean_y), 0, static_cast<double>(s.sum_sr) * 3282.80635};
    double tiles = 0;
    for (uint b = 0; b < histogram_bins; ++b) {
        const double log10_y = 14 * (b + 0.5) / histogram_bins - 6;
        const auto i = std::min(static_cast<std::size_t>((log10_y + 6) * tone_points_per_decade), static_cast<std::size_t>(tone_points - 1));
        f.displayed_cd_m2 += s.histogram[b] * std::pow(10.0, static_cast<double>(tone.log10_displayed[i]));
        tiles += s.histogram[b];
    }
    f.displayed_cd_m2 /= std::max(tiles, 1.0);
    // As far as the panel shows the scene as it is, both means are the same number, whatever the histogram's bins.
    if (tone.exposure == 1.0f && s.max_y <= tone.straight_until_cd_m2) f.displayed_cd_m2 = f.scene_cd_m2;
    return f;
}

FrameInput Stage::adjusted(const FrameInput& input) {
    FrameInput out = input;
    std::vector<SceneFeedback> known;
    for (std::uint32_t view = 0; view < views_; ++view) known.push_back(feedback(view));
    for (Slot& slot : slots_)
        if (auto* model = dynamic_cast<AdjustsEyes*>(slot.model.get()); model && slot.failed.empty()) model->adjust(out, known);
    return out;
}

void Stage::record(gpu::Commands& commands, const FrameInput& measured) {
    assert(measured.eyes.size() == views_);
    input_ = adjusted(measured);
    commands.begin_stage("statistics");
    record_tiles(commands);
    commands.barrier();
    record_view_statistics(commands);
    commands.end_stage();
    const bool was_foveated = foveated_;
    not_foveated_ = foveation_ ? foveation_->refusal(input_) : std::string();
    foveated_ = foveation_ && not_foveated_.empty();
    record_adaptation(commands, input_);
    if (foveated_) {
        foveation_->record(commands, *this, input_, !was_foveated);
    } else {
        if (was_foveated) take_over(commands, foveation_->stage());
        record_pictures(commands, input_);
    }
    record_readbacks(commands);
}

void Stage::record_tiles(gpu::Commands& commands) {
    commands.dispatch(tiles_kernel_, {scene_, solid_angle_, tiles_}, SizePush{width_, height_}, {gpu::groups_for(tiles_x() * tiles_y(), 64), 1, views_});
}

const std::vector<Stage::Slot>& Stage::models_of_picture() const { return foveated_ ? foveation_->stage().slots_ : slots_; }

// Both stages have the same slots: they were given the same selection.
void Stage::take_over(gpu::Commands& commands, Stage& from) {
    commands.barrier();
    for (std::size_t i = 0; i < slots_.size(); ++i) {
        if (!changes_picture(slots_[i])) continue;
        commands.copy(from.slots_[i].gate, slots_[i].gate, sizeof(Gate));
        if (slots_[i].model && from.slots_[i].model) slots_[i].model->take_over(commands, *from.slots_[i].model);
    }
    commands.barrier();
}

std::string Stage::refusal_of_models() const {
    for (const Slot& slot : slots_) {
        if (!slot.model || !slot.failed.empty() || slot.model->is_identity()) continue;
        if (const std::string why = slot.model->needs_full_image(); !why.empty()) return fmt::format("{} {}", slot.choice.entry->name, why);
    }
    return {};
}

std::vector<const gpu::Buffer*> Stage::gates_of_pictures() const {
    std::vector<const gpu::Buffer*> gates;
    for (const Slot& slot : slots_)
        if (slot.recorded && changes_picture(slot)) gates.push_back(&slot.gate);
    return gates;
}

void Stage::record_adaptation(gpu::Commands& commands, const FrameInput& input) {
    for (Slot& slot : slots_) slot.recorded = slot.resting = false;
    for (Slot& slot : slots_)
        if (!changes_picture(slot)) record_part(slot, "", &Model::record, commands, input);
    for (Slot& slot : slots_) record_part(slot, ".plan", &PlansTone::plan, commands, input);
}

void Stage::record_pictures(gpu::Commands& commands, const FrameInput& input) {
    const auto begin = std::find_if(slots_.begin(), slots_.end(), &Stage::changes_picture);
    // Where the light on the retina is observed: before the lid, of which the observers know themselves; else where scene light ends, or,
    // without a tone model, before the first model that acts on what it observed.
    const auto tone = std::find_if(begin, slots_.end(), [](const Slot& slot) {
        const std::string_view name = slot.choice.entry->slot;
        return name == "eyelid" || name == "tone" || dynamic_cast<ObservesRetina*>(slot.model.get());
    });
    for (auto slot = begin; slot != slots_.end(); ++slot) slot->recorded = slot->resting = false;
    for (auto slot = begin; slot != tone; ++slot) record_part(*slot, "", &Model::record, commands, input);
    for (Slot& slot : slots_) record_part(slot, ".observe", &ObservesRetina::observe, commands, input);
    for (auto slot = tone; slot != slots_.end(); ++slot) record_part(*slot, "", &Model::record, commands, input);
}

// Pupils and adaptation are states of the eyes; the other models change the picture by them. In pipeline order the former come first.
bool Stage::changes_picture(const Slot& slot) { return slot.choice.entry->slot != "pupil" && slot.choice.entry->slot != "adaptation"; }

bool Stage::obeys_residual_law() const {
    return std::all_of(slots_.begin(), slots_.end(), [](const Slot& s) { return !s.model || !s.failed.empty() || s.model->is_identity() || s.model->obeys_residual_law(); });
}

bool Stage::at_rest() const {
    return std::ranges::all_of(models_of_picture(), [](const Slot& s) { return s.gate_readback.as<Gate>()[0].ran == 0; });
}

void Stage::record_at_rest(gpu::Commands& commands, const FrameInput& input) {
    assert(input.eyes.size() == views_);
    input_ = adjusted(input);
    input_.within_display = input_.glanced = true;
    const FrameInput& inside = input_;
    commands.begin_stage("statistics");
    if (foveated_) take_over(commands, foveation_->stage());
    foveated_ = false;
    not_foveated_ = "nothing is simulated in this frame";
    record_view_statistics(commands);
    commands.end_stage();
    for (Slot& slot : slots_) {
        const bool adapts = !changes_picture(slot);
        slot.recorded = false;
        slot.resting = !adapts && slot.model && slot.failed.empty() && !slot.model->is_identity();
        if (adapts) record_part(slot, "", &Model::record, commands, inside);
    }
    for (Slot& slot : slots_) record_part(slot, ".plan", &PlansTone::plan, commands, inside);
    record_readbacks(commands);
}

void Stage::record_view_statistics(gpu::Commands& commands) {
    commands.dispatch(statistics_kernel_, {tiles_, statistics_}, StatisticsPush{tiles_x() * tiles_y(), context_.display.black_cd_m2}, {views_, 1, 1});
    commands.barrier();
}

void Stage::record_gate_readbacks(gpu::Commands& commands) {
    for (Slot& slot : slots_)
        if (slot.recorded) commands.copy(slot.gate, slot.gate_readback, sizeof(Gate));
}

void Stage::record_readbacks(gpu::Commands& commands) {
    record_gate_readbacks(commands);
    if (foveated_) foveation_->stage().record_gate_readbacks(commands);
    commands.copy(statistics_, statistics_readback_, statistics_.size());
    commands.copy(state_, state_readback_, state_.size());
    commands.barrier();
    has_depth_ = false;
}

Result<void> Stage::record_download(gpu::Commands& commands, std::uint32_t view) {
    assert(view < views_);
    if (!downloads_[view]) {
        ENTOPTIC_TRY(download, gpu::Buffer::create(device_, view_bytes(), gpu::BufferKind::readback, "download"));
        downloads_[view] = std::move(download);
    }
    commands.copy(scene_, downloads_[view], view_bytes(), view * view_bytes());
    return {};
}

ImageF Stage::downloaded(std::uint32_t view) const {
    ImageF image(static_cast<int>(width_), static_cast<int>(height_), 3);
    const auto pixels = downloads_[view].as<vec4>();
    for (std::size_t i = 0; i < pixels.size() && i * 3 < image.data.size(); ++i)
        for (int c = 0; c < 3; ++c) image.data[i * 3 + static_cast<std::size_t>(c)] = pixels[i][c];
    return image;
}

std::vector<EffectOutcome> Stage::effects() const {
    std::vector<EffectOutcome> outcomes;
    const std::vector<Slot>& ran = models_of_picture();
    for (std::size_t i = 0; i < slots_.size(); ++i) outcomes.push_back(outcome_of(changes_picture(slots_[i]) ? ran[i] : slots_[i]));
    if (foveation_) outcomes.push_back(foveation_outcome());
    return outcomes;
}

EffectOutcome Stage::foveation_outcome() const {
    EffectOutcome outcome{"foveation", name_of(selection_.foveation.inverse), foveated_, false, {}, {}, 0};
    const EyeGeometry& g = foveation_->geometry();
    outcome.why = foveated_ ? fmt::format("runs: models on {}x{} texels a view", g.width, g.height) : "the full image: " + not_foveated_;
    return outcome;
}

EffectOutcome Stage::outcome_of(const Slot& slot) {
    const Gate& gate = slot.gate_readback.as<Gate>()[0];
    EffectOutcome outcome{std::string(slot.choice.entry->slot), std::string(slot.choice.entry->name), slot.recorded || slot.resting, false, slot.failed, {}, 0};
    // A model that has no gate never sets a counter: it always runs.
    outcome.gated = slot.resting || (slot.recorded && gate.ran == 0 && gate.frames_run + gate.frames_gated > 0);
    outcome.bound_codes = outcome.gated && !slot.resting ? gate.bound : 0;
    if (!slot.failed.empty()) outcome.why = "switched off: " + slot.failed;
    else if (slot.resting) outcome.why = "not needed: all light of the frame is within the display's range";
    else if (!slot.recorded) outcome.why = "its parameters change nothing";
    else if (outcome.gated) outcome.why = fmt::format("cannot be seen in this frame (at most {:.3g} of a code value)", gate.bound);
    else outcome.why = "runs";
    return outcome;
}

ViewOutcome Stage::view(std::uint32_t index) const {
    const SceneStatistics& s = statistics_readback_.as<SceneStatistics>()[index];
    const ObserverState& o = state_readback_.as<ObserverState>()[index];
    return {o.adaptation_cd_m2, o.target_cd_m2, s.min_y, s.max_y, s.mean_y, s.cleaned};
}

void Stage::accumulate_totals() {
    for (const EffectOutcome& outcome : effects()) {
        Totals& total = totals_[outcome.slot];
        total.recorded += outcome.recorded && !outcome.gated;
        total.gated += outcome.gated || (!outcome.recorded && outcome.failed.empty());
        total.failed += !outcome.failed.empty();
        total.why = outcome.why;
    }
}

}  // namespace entoptic::perception
