// Where the two models differ, in sentences.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/decimals.hpp"
#include "report/number_text.hpp"
#include "report/results.hpp"
#include "report/second_opinion_parts.hpp"

namespace talus::report {
namespace {

struct Sentence {
    double size = 0;  ///< of the difference: the logarithm of the ratio
    std::string text;
};

/// 0: the same, or unknown in both; infinite: one of them has no value, or none above 0.
double size_of(double particles, double depth_averaged) {
    const bool p = particles > 0, d = depth_averaged > 0;
    if (!p && !d) return 0;
    return p && d ? std::abs(std::log(depth_averaged / particles)) : std::numeric_limits<double>::infinity();
}

std::string change_text(double particles, double depth_averaged) {
    const double percent = percent_more(particles, depth_averaged);
    if (!std::isfinite(percent)) return "";
    return fmt::format(", {} %", std::abs(percent) < 0.5 ? "0" : formatted(percent, "d0"));
}

std::string with_unit(double value, const std::string& format, const char* unit) {
    return std::isfinite(value) ? formatted(value, format) + (*unit == 0 ? "" : fmt::format("\u00a0{}", unit)) : "none";
}

/// "12.1 m/s with particles, 14.0 m/s depth-averaged, +16 %". `at`: in brackets, of each.
std::string pair_text(double particles, double depth_averaged, const std::string& format, const char* unit,
                      const std::array<std::string, 2>& at = {}) {
    const auto place = [](const std::string& where) { return where.empty() ? "" : fmt::format(" ({})", where); };
    return fmt::format("{} with particles{}, {} depth-averaged{}{}", with_unit(particles, format, unit), place(at[0]),
                       with_unit(depth_averaged, format, unit), place(at[1]), change_text(particles, depth_averaged));
}

std::array<std::string, 2> places(const scene::Scene& scene, const run::MapPair& maps) {
    const auto of = [&](const observe::Peak& peak) { return peak.value > 0 ? place(scene, peak.at) : std::string(); };
    return {of(maps.peak_particles), of(maps.peak_depth_averaged)};
}

/// The medians over the ground of both, which one cell does not change.
std::string medians_text(const char* what, const run::MapPair& maps, const std::string& format, const char* unit) {
    if (!std::isfinite(maps.median_particles)) return "";
    return fmt::format(" Over the ground that both cover, the median of the {} is {} and {}{}.", what,
                       with_unit(maps.median_particles, format, unit),
                       with_unit(maps.median_depth_averaged, format, unit),
                       change_text(maps.median_particles, maps.median_depth_averaged));
}

Sentence speed(const BothModels& models, const run::SecondOpinion& opinion) {
    const run::MapPair &v = opinion.speed, &q = opinion.pressure;
    const double p = v.peak_particles.value, d = v.peak_depth_averaged.value;
    if (!(p > 0) && !(d > 0)) return {};
    const double pressure_p = q.peak_particles.value / 1e3, pressure_d = q.peak_depth_averaged.value / 1e3;
    return {std::max(size_of(p, d), size_of(pressure_p, pressure_d)),
            fmt::format("Peak speed: {}. Peak dynamic pressure: {} and {}{}.{}",
                        pair_text(p, d, "f1", "m/s", places(models.scene, v)), with_unit(pressure_p, "s3", "kPa"),
                        with_unit(pressure_d, "s3", "kPa"), change_text(pressure_p, pressure_d),
                        medians_text("peak speed", v, "f1", "m/s"))};
}

Sentence depth(const BothModels& models, const run::SecondOpinion& opinion) {
    const run::MapPair& h = opinion.depth;
    const double p = h.peak_particles.value, d = h.peak_depth_averaged.value;
    if (!(p > 0) && !(d > 0)) return {};
    const std::string metres = fmt::format("f{}", length_decimals(models.scene, 1));
    std::string text = fmt::format("Peak depth: {}.", pair_text(p, d, metres, "m", places(models.scene, h)));
    if (h.largest.known() && h.largest.size() != 0) {
        text +=
            fmt::format(" At one place the peak depths differ most {}: {} and {}.", place(models.scene, h.largest.at),
                        with_unit(h.largest.particles, metres, "m"), with_unit(h.largest.depth_averaged, metres, "m"));
    }
    return {size_of(p, d), text + medians_text("peak depth", h, metres, "m")};
}

Sentence area(const BothModels& models, const run::AreaAgreement& area) {
    const double iou = area.intersection_over_union();
    if (std::isnan(iou)) return {};
    const int decimals = decimals_for(area.both + area.only_first + area.only_second, 0);
    return {
        -std::log(iou),
        fmt::format("Both models cover {}\u00a0m² deeper than {}\u00a0m, {} % of what either covers; {}\u00a0m² are "
                    "covered with particles only, {}\u00a0m² in the depth-averaged model only.",
                    fixed(area.both, decimals), plain(models.scene.spec.outputs.arrival_depth), fixed(100 * iou, 0),
                    fixed(area.only_first, decimals), fixed(area.only_second, decimals))};
}

Sentence arrival(const run::LargestDifference& arrival) {
    if (!arrival.known() || arrival.size() == 0) return {};
    return {size_of(arrival.particles, arrival.depth_averaged),
            fmt::format("The fronts are farthest apart in time at chainage {}\u00a0m, where particles arrive after "
                        "{}\u00a0s and the depth-averaged front {}\u00a0s {}.",
                        fixed(arrival.chainage, 0), fixed(arrival.particles, 1), fixed(std::abs(arrival.size()), 1),
                        arrival.size() < 0 ? "earlier" : "later")};
}

/// Chainages end with the path, and say nothing of debris that lies beside it.
std::string path_text(const BothModels& models) {
    const terrain::FlowPath& path = models.scene.flow_path;
    const auto &p = models.particles.observation.run_out, &d = models.depth_averaged.observation.run_out;
    const double end = path.length() - models.scene.spec.outputs.chainage_interval;
    const bool particles_end = p.front_chainage >= end, depth_averaged_end = d.front_chainage >= end;
    std::string text;
    if (models.scene.flow_path_origin != scene::PathOrigin::followed && (particles_end || depth_averaged_end)) {
        text = fmt::format("; the path ends at {}\u00a0m, which the front {} reached: it may have gone farther",
                           fixed(path.length(), 0),
                           particles_end && depth_averaged_end ? "of both"
                           : particles_end                     ? "of the particles"
                                                               : "of the depth-averaged model");
    }
    for (const auto& [run_out, model] : {std::pair{&p, "with particles"}, {&d, "in the depth-averaged model"}}) {
        if (std::isnan(run_out->toe.x) || path.locate(run_out->toe)) continue;
        text += fmt::format("; the farthest deposit {} lies beside the path, where there is no chainage", model);
    }
    return text;
}

Sentence run_out(const BothModels& models) {
    const auto &p = models.particles.observation.run_out, &d = models.depth_averaged.observation.run_out;
    if (!std::isfinite(p.along_flow) && !std::isfinite(d.along_flow)) return {};
    std::string text = "Run-out along the flow: " + pair_text(p.along_flow, d.along_flow, "f0", "m");
    if (p.at_least || d.at_least) {
        text += fmt::format("; debris left the terrain {}, where run-out is at least that",
                            p.at_least && d.at_least ? "in both"
                            : p.at_least             ? "with particles"
                                                     : "in the depth-averaged model");
    }
    if (!models.scene.flow_path.empty()) {
        text += fmt::format(". The front comes to chainage {} with particles and {} depth-averaged{}",
                            with_unit(p.front_chainage, "f0", "m"), with_unit(d.front_chainage, "f0", "m"),
                            path_text(models));
    }
    return {size_of(p.along_flow, d.along_flow), text + "."};
}

Sentence deposit(const BothModels& models) {
    const observe::Deposit &p = models.particles.observation.deposit, &d = models.depth_averaged.observation.deposit;
    if (!(p.area > 0) && !(d.area > 0)) return {};
    return {std::max(size_of(p.area, d.area), size_of(p.depth, d.depth)),
            fmt::format("Area of the deposit: {}; nine tenths of it are thinner than {} and {}{}.",
                        pair_text(p.area, d.area, "f0", "m²"), with_unit(p.depth, "f2", "m"),
                        with_unit(d.depth, "f2", "m"), change_text(p.depth, d.depth))};
}

std::vector<Sentence> front_velocities(const BothModels& models) {
    std::vector<Sentence> all;
    for (const params::ObservationSpec& observed : models.scene.spec.observations) {
        const auto at = [&](const run::RunResult& run) { return computed_for(observed, run.observation); };
        const double p = at(models.particles), d = at(models.depth_averaged);
        if (std::isnan(p) && std::isnan(d)) continue;
        all.push_back({size_of(p, d), fmt::format("{} at chainage {}\u00a0m: {}; observed {}.", observed.quantity(),
                                                  plain(observed.chainage), pair_text(p, d, "f1", "m/s"),
                                                  with_unit(observed.value(), "f1", "m/s"))});
    }
    return all;
}

/// Which structures are hit: the largest difference of all where one is hit in one model only.
Sentence hits(const BothModels& models) {
    std::array<std::vector<std::string>, 4> names;
    std::size_t count = 0;
    for_each_structure(models, [&](const auto& p, const auto&, HitBy by) {
        names.at(by).push_back(name_of(p));
        ++count;
    });
    if (count == names[neither].size()) return {};
    constexpr std::size_t most_named = 6;
    std::string text = fmt::format("Of {}, {} {} hit in both models", plural(count, "structure"), names[both].size(),
                                   names[both].size() == 1 ? "is" : "are");
    for (const auto& [by, model] :
         {std::pair{particles_only, "with particles"}, std::pair{depth_averaged_only, "in the depth-averaged model"}}) {
        std::vector<std::string>& list = names.at(by);
        if (list.empty()) continue;
        const std::size_t more = list.size() > most_named ? list.size() - most_named : 0;
        list.resize(list.size() - more);
        text += fmt::format("; {}{} only {}", fmt::join(list, ", "), more > 0 ? fmt::format(" and {} more", more) : "",
                            model);
    }
    const bool differ = !names[particles_only].empty() || !names[depth_averaged_only].empty();
    return {differ ? std::numeric_limits<double>::infinity() : 0, text + "."};
}

/// On the structure hit in both where it differs most.
Sentence impact(const BothModels& models) {
    Sentence found;
    for_each_structure(models, [&](const observe::BuildingImpact& p, const observe::BuildingImpact& d, HitBy by) {
        const double size = size_of(p.peak_impact_pressure, d.peak_impact_pressure);
        if (by != both || !(size > found.size)) return;
        found = {size, fmt::format("Impact pressure differs most on {}: {}.", name_of(p),
                                   pair_text(p.peak_impact_pressure / 1e3, d.peak_impact_pressure / 1e3, "s3", "kPa"))};
    });
    return found;
}

}  // namespace

std::vector<std::string> differences(const BothModels& models, const run::SecondOpinion& opinion) {
    std::vector<Sentence> all = front_velocities(models);
    for (Sentence& sentence :
         std::array{hits(models), impact(models), speed(models, opinion), depth(models, opinion), run_out(models),
                    area(models, opinion.area), arrival(opinion.arrival), deposit(models)}) {
        if (!sentence.text.empty()) all.push_back(std::move(sentence));
    }
    std::stable_sort(all.begin(), all.end(), [](const Sentence& a, const Sentence& b) { return a.size > b.size; });
    std::vector<std::string> texts;
    texts.reserve(all.size());
    for (Sentence& sentence : all) texts.push_back(std::move(sentence.text));
    return texts;
}

}  // namespace talus::report
