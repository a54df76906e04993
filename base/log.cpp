#include "base/log.h"

#include <cstdlib>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

namespace entoptic::log {
namespace {

spdlog::level::level_enum to_spdlog(Level level) {
    switch (level) {
    case Level::trace: return spdlog::level::trace;
    case Level::debug: return spdlog::level::debug;
    case Level::info: return spdlog::level::info;
    case Level::warn: return spdlog::level::warn;
    case Level::error: return spdlog::level::err;
    }
    return spdlog::level::err;
}

// A logger of our own: the host application may use spdlog's default one. Never destroyed, since threads may log at exit.
spdlog::logger& logger() {
    static spdlog::logger* instance = [] {
        auto* created = new spdlog::logger("entoptic", std::make_shared<spdlog::sinks::stderr_color_sink_mt>());
        created->set_pattern("entoptic: %l: %v");
        created->set_level(spdlog::level::warn);
        const char* wanted = std::getenv("ENTOPTIC_LOG");
        const auto level = wanted ? spdlog::level::from_str(wanted) : spdlog::level::warn;
        if (wanted && level != spdlog::level::off) created->set_level(level);
        return created;
    }();
    return *instance;
}

}  // namespace

void set_level(Level level) { logger().set_level(to_spdlog(level)); }

bool set_level(const std::string& name) {
    const auto level = spdlog::level::from_str(name);
    if (level == spdlog::level::off) return false;
    logger().set_level(level);
    return true;
}

bool enabled(Level level) { return logger().should_log(to_spdlog(level)); }

void write(Level level, const std::string& message) { logger().log(to_spdlog(level), "{}", message); }

}  // namespace entoptic::log
