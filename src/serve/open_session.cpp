#include "serve/open_session.hpp"

#include <utility>

#include "core/try.hpp"
#include "serve/api.hpp"
#include "serve/option_scenarios.hpp"
#include "serve/recorder.hpp"
#include "serve/server.hpp"
#include "twin/live_run.hpp"

namespace talus::serve {

OpenSession::OpenSession(Thread thread, Executor& executor, std::shared_ptr<const scene::Scene> scene,
                         const ServerOptions& options)
    : session(std::move(thread), executor, scene, options.tokens),
      exports(session, options.export_folder, options.calibration.source),
      calibrations(executor, scene, options.calibration,
                   [this](nlohmann::json status) { session.calibration(std::move(status)); }),
      alerts(session, std::move(scene), options.alerts),
      depth_averaged(session),
      overlays(session, options.export_folder / "overlays", options.reader, options.tiles),
      flows(session, options.export_folder) {}

Result<OpenSessionPtr> OpenSession::open(const Thread& thread, Executor& executor,
                                         const std::shared_ptr<const scene::Scene>& scene, const ServerOptions& options,
                                         std::vector<OpeningScenario> scenarios, std::vector<Overlay> laid,
                                         const std::vector<TileAddress>& tiles) {
    auto made = std::make_shared<OpenSession>(thread, executor, scene, options);
    TALUS_ASSIGN(made->ensembles, Ensembles::read(options.ensembles, *scene));
    const auto on_failure = options.on_failure ? options.on_failure : [](const std::string&) {};
    TALUS_TRY(made->session.open(options.scenario, on_failure));
    made->session.calibration(made->calibrations.describe());
    made->router =
        make_api(made->session, made->exports, made->ensembles, made->calibrations, made->alerts, made->overlays);
    add_flow_routes(made->router, made->flows);
    if (published_page()) made->exports.offer_twin([raw = made.get()](const Respond& r) { raw->twin_page.file(r); });
    made->overlays.open(std::move(laid), tiles);
    add_depth_averaged_routes(made->router, made->session, made->depth_averaged);
    if (const Status opened = made->alerts.open(); !opened) {
        retire(thread, std::move(made));
        return opened.error();
    }
    // A saved session has its scenarios.
    auto options_of_scene =
        scenarios.empty() ? option_scenarios(*scene, options.calibration.source) : std::vector<OptionScenario>();
    const auto shared = std::make_shared<std::vector<OpeningScenario>>(std::move(scenarios));
    // On the server's thread, which may be another one: it follows setups from when all of this is open. The task after
    // it sends the first one again.
    made->session.post([raw = made.get()] {
        raw->session.on_first_setup([raw](const twin::Setup& setup) {
            raw->alerts.follow_triggers(bodies_of(setup.triggers));
            raw->calibrations.follow(bodies_of(setup.observations));
        });
    });
    made->session.loop().post(
        [shared, raw = made.get(), run = options.run, options = std::move(options_of_scene)](Scenarios& all) {
            for (OpeningScenario& one : *shared) all.put(one.index, std::move(one.scenario), one.title);
            raw->session.setup(0, all.setup(0), all.at(0).run().setup());
            offer_options(all, options);
            if (run) all.act(0, {{"action", "run"}}, "", [](const Result<twin::Done>&) {});
        });
    return made;
}

void OpenSession::close() {
    // Threads and lanes end while everything that they notify still exists.
    twin_page.close();
    calibrations.close();
    alerts.close();
    depth_averaged.close();
    overlays.close();
    session.close();
    exports.close();
    flows.close();
}

void OpenSession::retire(const Thread& thread, OpenSessionPtr session) {
    session->close();
    thread.post([post = thread.post, session = std::move(session)] { post([session] {}); });
}

}  // namespace talus::serve
