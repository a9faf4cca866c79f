// The setup as docs/protocol.md has it: as in a setup file, with what the page cannot find out by itself.
#include <memory>
#include <utility>

#include "core/number_or_null.hpp"
#include "twin/kinds.hpp"
#include "twin/scenario_parts.hpp"

namespace talus::twin {

using nlohmann::json;

json Scenario::setup_json() const {
    const Parts& p = *parts_;
    const Setup& setup = p.setup();
    const Setup& begun_with = p.run->begun_with();
    json parameters = json::object(), changes = json::array();
    for (const params::Parameter* parameter : live_parameters()) {
        parameters["material." + parameter->key] =
            number_or_null<json>(value_in_force(setup.material, *parameter, p.run->model().viscosity));
    }
    for (const Parts::ChangeOnTheWay& change : p.changes) {
        changes.push_back({{"time_s", change.time}, {"by", change.by}, {"sentence", change.sentence}});
    }
    json answer = {{"revision", p.revision},
                   {"changes", changes},
                   {"parameters", parameters},
                   {"pending_restart", !begin_alike(setup, begun_with)},
                   {"undo", p.undo.empty() ? json() : json(p.undo.back().sentence)},
                   {"redo", p.redo.empty() ? json() : json(p.redo.back().sentence)}};
    ZoneBlocks blocks;
    Shown shown{*p.run, p.scene->terrain.elevation().geometry, p.zone_blocks, blocks};
    for_each_kind([&]<class Kind>(Kind) {
        json& list = answer[Kind::list] = json::array();
        for (const auto& entry : setup.*Kind::entries) {
            json row = Kind::body(*entry.body);
            row.update(Kind::more(entry, shown));
            row["id"] = entry.id;
            if (Kind::origin != Origin::none) row["from_scene"] = entry.scene_index >= 0;
            if constexpr (Kind::from_time_0) {
                const auto* begun = find_id(begun_with.*Kind::entries, entry.id);
                row["in_force"] = begun != nullptr && same_shape(begun->body, entry.body);
            }
            list.push_back(std::move(row));
        }
    });
    p.zone_blocks = std::move(blocks);
    return answer;
}

}  // namespace talus::twin
