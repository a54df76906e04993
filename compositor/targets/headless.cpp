#include "compositor/targets/headless.h"

namespace entoptic::compositor {
namespace {

class Headless final : public DisplayTarget {
public:
    Result<void> test(const PresentState&) override { return {}; }
    Result<void> commit(const PresentState&) override { return {}; }
    std::string description() const override { return "headless"; }
};

}  // namespace

std::unique_ptr<DisplayTarget> make_headless_target() { return std::make_unique<Headless>(); }

}  // namespace entoptic::compositor
