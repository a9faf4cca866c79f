#include "serve/twin_page.hpp"

#include <exception>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "core/try.hpp"
#include "serve/publisher.hpp"

namespace talus::serve {
namespace {

Result<std::string> make_page(OpenSession& open, const std::atomic<bool>& stop) {
    TALUS_ASSIGN(const auto page, published_page());
    TALUS_ASSIGN(const auto recorded, record(open, {}, [&](const std::string&, double) { return !stop; }));
    publish::Content content;
    content.title = open.session.scene()->spec.scene.title;
    content.about = describe_twin(*open.session.scene(), false);
    content.tape = recorded.tape.pack();
    TALUS_TRY(check_twin_size(content.tape.size()));
    return publish::one_file(page, content);
}

}  // namespace

TwinPage::TwinPage(OpenSession& open)
    : open_(open), writer_(open.session.executor(), "twin page", Priority::background) {}

void TwinPage::close() {
    stop_ = true;
    writer_.close();
}

void TwinPage::file(const Respond& respond) {
    writer_.post([this, respond] {
        try {
            auto html = make_page(open_, stop_);
            if (stop_) return;
            if (!html) return respond(error_response(409, html.error().message));
            Response response;
            response.type = "text/html; charset=utf-8";
            response.body = std::make_shared<const std::string>(std::move(*html));
            response.file_name = "twin.html";
            respond(std::move(response));
        } catch (const std::exception& error) {
            respond(error_response(500, fmt::format("the twin cannot be made: {}", error.what())));
        }
    });
}

}  // namespace talus::serve
