#include "evaluation_options.hpp"

#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "core/try.hpp"

namespace talus::cli {

Status set_evaluation(ensemble::EnsemblePlan& plan, const Evaluation& evaluation) {
    const auto set = [](std::vector<double>& values, const std::string& text, const char* option) -> Status {
        if (text.empty()) return {};
        TALUS_ASSIGN(values, ensemble::parse_thresholds(text, option));
        return {};
    };
    TALUS_TRY(set(plan.thresholds.depth, evaluation.depths, "--depth-m"));
    TALUS_TRY(set(plan.thresholds.speed, evaluation.speeds, "--speed-mps"));
    TALUS_TRY(set(plan.thresholds.pressure, evaluation.pressures, "--pressure-kPa"));
    if (const auto years = evaluation.return_period) {
        if (!std::isfinite(*years) || !(*years > 0)) {
            return Error{fmt::format("--return-period {} is refused; it must be a number above 0 (years)", *years)};
        }
        plan.return_period = years;
    }
    return {};
}

void add_evaluation(CLI::App& command, Evaluation& evaluation) {
    command.add_option("--depth-m", evaluation.depths, "peak depths whose probability is mapped; default: 0.1,0.5,1")
        ->type_name("M,M");
    command.add_option("--speed-mps", evaluation.speeds, "likewise peak speeds; default: 5,10")->type_name("MPS,MPS");
    command.add_option("--pressure-kPa", evaluation.pressures, "likewise pressures, on buildings too; default: 15,30")
        ->type_name("KPA,KPA");
    command
        .add_option("--return-period", evaluation.return_period,
                    "of the event that the runs are samples of: maps hazard zones")
        ->type_name("YEARS");
}

}  // namespace talus::cli
