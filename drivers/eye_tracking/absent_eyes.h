// An eye tracker that is not there: looks straight ahead, and says so.
#pragma once

#include "interfaces/sources.h"

#include <string>

namespace entoptic::drivers {

class AbsentEyes final : public EyeSource {
public:
    explicit AbsentEyes(std::string why) : why_(std::move(why)) {}
    Observer observer_at(TimeNs time) override {
        Observer observer;
        observer.time = time;
        return observer;
    }
    std::optional<RawEyeSample> raw_at(int, TimeNs) override { return std::nullopt; }
    bool present() const override { return false; }
    std::string description() const override { return why_; }

private:
    std::string why_;
};

}  // namespace entoptic::drivers
