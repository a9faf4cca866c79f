#include <algorithm>
#include <chrono>
#include <cstddef>
#include <deque>
#include <emscripten/emscripten.h>
#include <exception>
#include <map>
#include <memory>
#include <new>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "pack/pack.hpp"
#include "page.hpp"
#include "session/page_api.hpp"
#include "session/session.hpp"

/// A session behind functions of C, for web/src/engine/engine.ts. Texts are UTF-8 and have a length. A function that
/// fails returns 0, and the result is a sentence.
namespace talus::web_engine {
namespace {

using session::Bytes;
using session::Clock;

/// What a person is to be sent.
struct Message {
    int client = 0;
    bool binary = false;
    Bytes bytes;
};

struct Engine {
    std::unique_ptr<session::Session> session;
    std::unique_ptr<session::PageApi> api;
    std::map<int, std::string> people;  // ids, by client
    int clients = 0;
    std::deque<Message> outgoing;

    void collect() {
        for (const auto& [client, id] : people) {
            for (Bytes& text : session->events(id)) outgoing.push_back({client, false, std::move(text)});
            for (Bytes& frame : session->frames(id)) outgoing.push_back({client, true, std::move(frame)});
        }
    }
};

Engine engine;
std::string result_type;
Bytes result;

void set_result(std::string text, std::string type = "text/plain") {
    result = std::make_shared<const std::string>(std::move(text));
    result_type = std::move(type);
}

/// Does the work; whatever is thrown becomes a sentence.
template <class Work>
int guarded(const Work& work) {
    try {
        return work();
    } catch (const std::bad_alloc&) {
        set_result("the page has no memory left for this; a scene with fewer particles or cells needs less");
    } catch (const std::exception& error) {
        set_result(std::string("the engine failed: ") + error.what());
    }
    return 0;
}

Clock::time_point now() {
    return Clock::now();
}

int open(std::span<const std::byte> bytes) {
    engine = {};
    auto packed = pack::read(bytes, "the packed scene");
    if (!packed) {
        set_result(packed.error().message);
        return 0;
    }
    set_latitude(packed->latitude);
    const auto scene = std::make_shared<const scene::Scene>(std::move(packed->scene));
    session::Session::Setup setup{.scene = scene, .program = "talus " TALUS_VERSION " (page)"};
    setup.options.overrides = std::move(packed->overrides);
    setup.options.recording_bytes = 256'000'000;
    auto opened = session::Session::open(std::move(setup));
    if (!opened) {
        set_result(opened.error().message);
        return 0;
    }
    engine.session = std::move(*opened);
    std::optional<session::PageApi::Picture> picture;
    if (packed->orthophoto) {
        picture = {std::move(packed->orthophoto->type),
                   std::make_shared<const std::string>(std::move(packed->orthophoto->bytes))};
    }
    engine.api = std::make_unique<session::PageApi>(*engine.session, *scene, std::move(picture));
    set_result(engine.session->hash());
    return 1;
}

int join(std::string name) {
    const int client = ++engine.clients;
    engine.people[client] = engine.session->join(session::Role::controller, name, now());
    engine.collect();
    return client;
}

int request(int client, const std::string& method, std::string_view target, std::string_view body) {
    const auto person = engine.people.find(client);
    session::PageAnswer answer =
        engine.api->answer(method, target, body, person == engine.people.end() ? "" : person->second, now);
    engine.collect();
    result = std::move(answer.body);
    result_type = std::move(answer.type);
    return answer.status;
}

std::string text(const char* data, int size) {
    return {data, static_cast<std::size_t>(size)};
}

}  // namespace
}  // namespace talus::web_engine

using talus::web_engine::engine;

extern "C" {

/// 1: the result is the hash of the state at time 0.
EMSCRIPTEN_KEEPALIVE int talus_open(const char* data, int size) {
    return talus::web_engine::guarded(
        [&] { return talus::web_engine::open(std::as_bytes(std::span(data, static_cast<std::size_t>(size)))); });
}

/// The client's number; 0: no scene is open.
EMSCRIPTEN_KEEPALIVE int talus_join(const char* name, int size) {
    if (!engine.session) return 0;
    return talus::web_engine::guarded([&] { return talus::web_engine::join(talus::web_engine::text(name, size)); });
}

EMSCRIPTEN_KEEPALIVE void talus_leave(int client) {
    const auto found = engine.people.find(client);
    if (found == engine.people.end()) return;
    engine.session->leave(found->second, talus::web_engine::now());
    engine.people.erase(found);
    engine.collect();
}

/// 0: it violates the protocol.
EMSCRIPTEN_KEEPALIVE int talus_message(int client, const char* data, int size) {
    const auto found = engine.people.find(client);
    if (found == engine.people.end()) return 0;
    return talus::web_engine::guarded([&] {
        const bool welcome =
            engine.session->receive(found->second, talus::web_engine::text(data, size), talus::web_engine::now());
        engine.collect();
        return welcome ? 1 : 0;
    });
}

/// The status of HTTP; the result is the body. 0: the engine failed, and the result is a sentence.
EMSCRIPTEN_KEEPALIVE int talus_request(int client, const char* method, int method_size, const char* target,
                                       int target_size, const char* body, int body_size) {
    if (!engine.session) return 0;
    return talus::web_engine::guarded([&] {
        return talus::web_engine::request(client, talus::web_engine::text(method, method_size),
                                          talus::web_engine::text(target, target_size),
                                          talus::web_engine::text(body, body_size));
    });
}

/// Works for about so long. Milliseconds until it has more to do: 0: at once; -1: not before another call; -2: the
/// engine failed, and the result is a sentence.
EMSCRIPTEN_KEEPALIVE double talus_tick(double budget_ms) {
    if (!engine.session) return -1;
    double wait = -1;
    const int worked = talus::web_engine::guarded([&] {
        using std::chrono::duration;
        const auto budget = std::chrono::duration_cast<talus::session::Clock::duration>(
            duration<double, std::milli>(std::clamp(budget_ms, 0.0, 1e4)));
        const auto next = engine.session->advance(talus::web_engine::now, budget);
        engine.collect();
        if (next) wait = std::max(0.0, duration<double, std::milli>(*next - talus::web_engine::now()).count());
        return 1;
    });
    return worked == 1 ? wait : -2;
}

/// Takes the next message to a person: the result. The client's number, negative for a frame; 0: there is none.
EMSCRIPTEN_KEEPALIVE int talus_next_message() {
    if (engine.outgoing.empty()) return 0;
    talus::web_engine::Message message = std::move(engine.outgoing.front());
    engine.outgoing.pop_front();
    talus::web_engine::result = std::move(message.bytes);
    return message.binary ? -message.client : message.client;
}

EMSCRIPTEN_KEEPALIVE const char* talus_result() {
    return talus::web_engine::result ? talus::web_engine::result->data() : nullptr;
}
EMSCRIPTEN_KEEPALIVE int talus_result_size() {
    return talus::web_engine::result ? static_cast<int>(talus::web_engine::result->size()) : 0;
}
EMSCRIPTEN_KEEPALIVE const char* talus_result_type() {
    return talus::web_engine::result_type.c_str();
}

}  // extern "C"
