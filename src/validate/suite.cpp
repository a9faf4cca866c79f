#include "validate/suite.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>

#include <fmt/format.h>

#include "run/threads.hpp"
#include "validate/kind.hpp"

namespace talus::validate {
namespace {

const Kind& kind_of(const Case& validation_case) {
    for (const Kind& kind : kinds()) {
        if (kind.name == validation_case.kind) return kind;
    }
    return kinds().front();  // load_case accepts no other kind
}

std::string with_place(const std::string& quantity, const std::string& where) {
    return where.empty() ? quantity : quantity + ", " + where;
}

Row judge_one(const Case& validation_case, const Expectation& e, const Measurement* measured) {
    const Quantity* quantity = kind_of(validation_case).find(e.quantity);
    Row row;
    row.case_name = validation_case.name;
    row.quantity = with_place(e.quantity, measured != nullptr ? measured->where : place_text(e));
    row.unit = quantity != nullptr ? std::string(quantity->unit) : "";
    row.comparison = e.comparison;
    row.source = e.source;
    row.known_failure = e.known_failure;
    row.tolerance = e.tolerance;
    if (!row.tolerance && e.comparison != Comparison::near) row.tolerance = 0;
    if (e.expected) {
        row.expected = *e.expected;
    } else if (measured != nullptr && measured->law) {
        row.expected = *measured->law;
    }
    if (measured != nullptr) row.computed = measured->computed;
    const double scale = row.expected == 0 ? 1 : std::abs(row.expected);
    row.relative_error = (row.computed - row.expected) / scale;
    // Not std::max: a value that was not computed must remain so.
    if (e.comparison == Comparison::at_most && row.relative_error < 0) row.relative_error = 0;
    if (e.comparison == Comparison::at_least && row.relative_error > 0) row.relative_error = 0;
    const bool pass = row.tolerance && std::isfinite(row.computed) && std::abs(row.relative_error) <= *row.tolerance;
    // Coarser resolutions show the trend, unless the case file names one.
    const bool trend = measured != nullptr && measured->coarse && e.where.empty();
    row.verdict = !e.gate || trend          ? Verdict::shown
                  : pass                    ? Verdict::pass
                  : e.known_failure.empty() ? Verdict::fail
                                            : Verdict::known_failure;
    return row;
}

/// Why the case cannot be run here; empty if it can.
std::string missing_data(const Case& validation_case) {
    if (validation_case.needs_data.empty()) return {};
    const char* data = std::getenv("TALUS_DATA");
    if (data == nullptr || *data == 0) {
        return "TALUS_DATA does not say where " + validation_case.needs_data + " lies";
    }
    const std::filesystem::path file = std::filesystem::path(data) / validation_case.needs_data;
    std::error_code error;
    return std::filesystem::exists(file, error) ? "" : file.string() + " is not there";
}

Row skipped_row(const Case& validation_case, const Expectation& e) {
    Row row = judge_one(validation_case, e, nullptr);
    row.verdict = Verdict::skipped;
    return row;
}

}  // namespace

std::string place_text(const Expectation& e) {
    std::string place;
    if (e.chainage) place = fmt::format("at chainage {:.6g} m", *e.chainage);
    if (!e.building.empty()) place = e.building;
    if (e.x && e.y && e.radius) place = fmt::format("within {:.6g} m of ({:.8g}, {:.8g})", *e.radius, *e.x, *e.y);
    if (place.empty()) return e.where;
    return with_place(place, e.where);
}

std::vector<Row> judge(const Case& validation_case, const std::vector<Measurement>& measurements) {
    const auto& expectations = validation_case.expectations;
    std::vector<bool> used(expectations.size(), false);
    std::vector<Row> rows;
    for (const Measurement& measured : measurements) {
        const auto add = [&](bool named) {
            bool any = false;
            for (std::size_t i = 0; i < expectations.size(); ++i) {
                const Expectation& e = expectations[i];
                const std::string place = place_text(e);
                if (e.quantity != measured.quantity || place != (named ? measured.where : "")) continue;
                rows.push_back(judge_one(validation_case, e, &measured));
                used[i] = any = true;
            }
            return any;
        };
        if (measured.where.empty() || !add(true)) add(false);
    }
    for (std::size_t i = 0; i < expectations.size(); ++i) {
        if (!used[i]) rows.push_back(judge_one(validation_case, expectations[i], nullptr));
    }
    return rows;
}

CaseResult run_case(const Case& validation_case, const Watch& watch) {
    CaseResult result;
    result.validation_case = validation_case;
    result.skipped = missing_data(validation_case);
    if (!result.skipped.empty()) {
        for (const Expectation& e : validation_case.expectations)
            result.rows.push_back(skipped_row(validation_case, e));
        return result;
    }
    const run::Threads threads(watch.thread_count);
    const auto start = std::chrono::steady_clock::now();
    Result<Outcome> outcome = threads.execute([&] { return validation_case.compute(watch); });
    result.wall_time = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (!outcome) {
        result.notes.push_back(outcome.error().message);
        result.rows = judge(validation_case, {});
        return result;
    }
    result.rows = judge(validation_case, outcome->measurements);
    result.charts = std::move(outcome->charts);
    result.notes = std::move(outcome->notes);
    return result;
}

Tally count(const std::vector<CaseResult>& results) {
    Tally tally;
    for (const CaseResult& result : results) {
        for (const Row& row : result.rows) {
            switch (row.verdict) {
                case Verdict::pass:
                    ++tally.passed;
                    break;
                case Verdict::fail:
                    ++tally.failed;
                    break;
                case Verdict::known_failure:
                    ++tally.known_failures;
                    break;
                case Verdict::shown:
                    ++tally.shown;
                    break;
                case Verdict::skipped:
                    ++tally.skipped;
                    break;
            }
        }
    }
    return tally;
}

}  // namespace talus::validate
