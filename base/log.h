// Messages for people, on standard error, through spdlog. Level from ENTOPTIC_LOG (trace|debug|info|warn|error; default warn).
#pragma once

#include <fmt/format.h>
#include <string>

namespace entoptic::log {

enum class Level { trace, debug, info, warn, error };

void set_level(Level level);
// False when the name is not a level.
bool set_level(const std::string& name);
bool enabled(Level level);
void write(Level level, const std::string& message);

template <class... Args> void write_formatted(Level level, fmt::format_string<Args...> format, Args&&... args) {
    if (enabled(level)) write(level, fmt::format(format, std::forward<Args>(args)...));
}
template <class... Args> void trace(fmt::format_string<Args...> f, Args&&... a) { write_formatted(Level::trace, f, std::forward<Args>(a)...); }
template <class... Args> void debug(fmt::format_string<Args...> f, Args&&... a) { write_formatted(Level::debug, f, std::forward<Args>(a)...); }
template <class... Args> void info(fmt::format_string<Args...> f, Args&&... a) { write_formatted(Level::info, f, std::forward<Args>(a)...); }
template <class... Args> void warn(fmt::format_string<Args...> f, Args&&... a) { write_formatted(Level::warn, f, std::forward<Args>(a)...); }
template <class... Args> void error(fmt::format_string<Args...> f, Args&&... a) { write_formatted(Level::error, f, std::forward<Args>(a)...); }

}  // namespace entoptic::log
