// Models that are a gate and one pass over pixels.
#pragma once

#include "perception/gate.h"
#include "perception/model.h"

namespace entoptic::perception {

// Bindings of the gate: ObserverState (0), Gate (1). Bindings of the pass: scene (0), ObserverState (1), EyeGeometry (2); its workgroups are
// those that the gate sets as dispatch 0.
class GatedPass {
public:
    template <class GatePush, class Push>
    static Result<GatedPass> create(const ModelContext& context, const std::string& name, std::span<const std::uint32_t> gate,
                                    std::span<const std::uint32_t> pass) {
        const auto storage = gpu::BindingKind::storage_buffer;
        GatedPass made;
        ENTOPTIC_TRY(gate_kernel, gpu::Kernel::create(context.device, {name + ".gate", gate, {storage, storage}, sizeof(GatePush), {}}));
        ENTOPTIC_TRY(pass_kernel, gpu::Kernel::create(context.device, {name, pass, {storage, storage, storage}, sizeof(Push), {}}));
        made.gate_ = std::move(gate_kernel);
        made.pass_ = std::move(pass_kernel);
        return made;
    }
    template <class GatePush> void record_gate(StageIo& io, const GatePush& push) {
        io.commands.dispatch(gate_, {io.state, io.gate}, push, {1, 1, 1});
        io.commands.barrier();
    }
    // Once for each view, if it has anything to do.
    template <class Push> void record_pass(StageIo& io, const Push& push) {
        io.commands.dispatch_indirect(pass_, {io.scene, io.state, io.geometry}, push, io.gate, offsetof(Gate, dispatch));
    }

private:
    gpu::Kernel gate_, pass_;
};

}  // namespace entoptic::perception
