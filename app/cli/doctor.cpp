// `entoptic doctor`: what works on this machine, and the command that mends what does not.
#include "app/cli/command.h"
#include "app/cli/output.h"
#include "app/system/checks.h"

#include <algorithm>
#include <fmt/format.h>
#include <memory>

namespace entoptic::app {
namespace {

constexpr int exit_machine_lacks = 3;

void print_finding(const Finding& finding) {
    fmt::print("{:<8} {:<15} {}\n", name_of(finding.state), finding.check, finding.what);
    if (!finding.mend.empty()) fmt::print("{:<24} {}\n", "", finding.mend);
}

Json findings_json(const std::vector<Finding>& findings, bool sound) {
    Json list = Json::array();
    for (const Finding& f : findings) list.push_back({{"check", f.check}, {"state", name_of(f.state)}, {"what", f.what}, {"mend", f.mend}});
    return {{"version", ENTOPTIC_VERSION}, {"sound", sound}, {"findings", list}};
}

Result<int> examine(bool json) {
    const std::vector<Finding> findings = check_machine();
    const bool sound = std::none_of(findings.begin(), findings.end(), [](const Finding& f) { return f.state == Finding::State::problem; });
    if (json)
        print_json(findings_json(findings, sound));
    else
        std::for_each(findings.begin(), findings.end(), print_finding);
    return sound ? 0 : exit_machine_lacks;
}

}  // namespace

void add_doctor(CLI::App& app, Action& action) {
    auto json = std::make_shared<bool>(false);
    CLI::App* command = app.add_subcommand("doctor", "Check driver, runtime, permissions and devices; each finding with what mends it");
    command->add_flag("--json", *json, "One JSON document on standard output");
    command->callback([json, &action] { action = [json] { return examine(*json); }; });
}

}  // namespace entoptic::app
