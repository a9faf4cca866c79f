#include <cstdlib>
#include <fstream>
#include <set>
#include <sstream>

#include <gmock/gmock.h>

#include "serve/protocol_pages.hpp"

namespace talus::test {
namespace {

using serve::parse_type;
using ::testing::HasSubstr;
using ::testing::StartsWith;

std::string read_file(const std::string& path) {
    std::ifstream file(path);
    std::stringstream text;
    text << file.rdbuf();
    return text.str();
}

/// PROTOCOL_REMAKE=1 writes it instead.
void expect_committed(const std::string& path, const std::string& text) {
    const std::string file = std::string(TALUS_SOURCE_DIR) + "/" + path;
    if (std::getenv("PROTOCOL_REMAKE") != nullptr) {
        std::ofstream(file) << text;
        return;
    }
    std::istringstream committed(read_file(file)), made(text);
    std::string line, expected;
    for (int number = 1; std::getline(made, expected); ++number) {
        std::getline(committed, line);
        ASSERT_EQ(line, expected) << file << ":" << number
                                  << ": PROTOCOL_REMAKE=1 ctest -R '^serve.Protocol' makes it again";
    }
    EXPECT_FALSE(std::getline(committed, line)) << file << " goes on: " << line;
}

TEST(Protocol, the_committed_types_of_the_page_are_those_of_the_description) {
    for (const char* group : {"messages", "start"}) {
        expect_committed(std::string("web/src/protocol/") + group + ".ts",
                         protocol_typescript(serve::protocol(), group));
    }
}

TEST(Protocol, the_committed_maps_of_the_page_are_those_of_their_table) {
    expect_committed("web/src/protocol/maps.ts", maps_typescript());
}

TEST(Protocol, the_committed_messages_of_the_program_are_those_of_the_description) {
    expect_committed("src/messages/messages.hpp", protocol_header(serve::protocol()));
    expect_committed("src/messages/messages.cpp", protocol_writers(serve::protocol()));
}

TEST(Protocol, the_committed_tables_are_those_of_the_description) {
    const std::string page = "docs/protocol.md";
    const auto made = with_protocol_tables(serve::protocol(), read_file(std::string(TALUS_SOURCE_DIR) + "/" + page));
    ASSERT_TRUE(made) << made.error().message;
    expect_committed(page, *made);
    for (const serve::RouteDescription& route : serve::protocol().routes) {
        EXPECT_THAT(*made, HasSubstr("| `" + route.method + " " + route.path + "` |"));
    }
    for (const serve::TypeDescription& type : serve::protocol().types) {
        EXPECT_THAT(*made, HasSubstr("\n#### " + type.name + "\n"));
    }
}

TEST(Protocol, every_type_is_used) {
    const serve::Protocol& all = serve::protocol();
    std::set<std::string> used{"Refusal"};  // the answer to whatever is refused
    const auto add = [&](const std::vector<serve::Field>& fields) {
        for (const serve::Field& field : fields) add_names(field.type, used);
    };
    for (const serve::RouteDescription& route : all.routes) {
        add(route.path_parameters);
        add_names(route.answer.type, used);
        if (route.body) add_names(route.body->type, used);
    }
    for (const serve::TypeDescription& type : all.types) {
        add(type.fields);
        used.insert(type.extends);
        if (type.is) add_names(*type.is, used);
    }
    for (const serve::UnionDescription& one : all.unions) {
        for (const serve::Variant& variant : one.variants) add(variant.fields);
    }
    for (const serve::TypeDescription& type : all.types) EXPECT_EQ(used.count(type.name), 1U) << type.name;
}

TEST(TypeNotation, is_written_again_as_typescript) {
    for (const char* text :
         {"number | null", "Point[][]", "[number, number]", "(number | null)[]", "Record<string, number[]>",
          "Partial<Record<Role, Draft>>", "{ viewer: string; controller?: string } | null", "1"}) {
        const auto type = parse_type(text);
        ASSERT_TRUE(type) << type.error().message;
        EXPECT_EQ(typescript_of(*type), text);
    }
    EXPECT_EQ(typescript_of(*parse_type("'held' | 'released'")), "\"held\" | \"released\"");
    EXPECT_THAT(typescript_of(*parse_type("'depth' | maps")), StartsWith("\"depth\" | \"peak_depth\" | \""));
    const auto bounded = parse_type("Point[](2..200)");
    ASSERT_TRUE(bounded);
    EXPECT_EQ(bounded->bounds, std::pair(2.0, 200.0));
    EXPECT_EQ(parse_type("number(0.05..100) | null")->parts[0].bounds, std::pair(0.05, 100.0));
    EXPECT_TRUE(parse_type("Point | null")->may_be_null());
    EXPECT_FALSE(parse_type("(number | null)[]")->may_be_null());
}

TEST(TypeNotation, an_error_says_what_was_expected_and_where) {
    const std::pair<const char*, const char*> wrong[] = {{"", "a type expected at character 1"},
                                                         {"number |", "a type expected at character 9"},
                                                         {"Point[", "the end expected at character 6"},
                                                         {"[number", "] expected at character 8"},
                                                         {"'held", "a closing quote expected at character 2"},
                                                         {"integer(1-2)", "a number expected at character 9"},
                                                         {"{ a string }", ": expected at character 5"},
                                                         {"Record<string>", ", expected at character 14"}};
    for (const auto& [text, message] : wrong) {
        const auto type = parse_type(text);
        ASSERT_FALSE(type) << text;
        EXPECT_THAT(type.error().message, HasSubstr(message)) << text;
    }
}

TEST(TypeNotation, a_field_has_a_sentence_and_may_be_absent) {
    const auto field = serve::parse_field("hash?", "string -- Of time and particles -- both");
    ASSERT_TRUE(field);
    EXPECT_EQ(field->key, "hash");
    EXPECT_TRUE(field->optional);
    EXPECT_EQ(field->doc, "Of time and particles -- both");
}

TEST(ReadProtocol, refuses_what_it_does_not_know) {
    const auto read = [](const std::string& route, const std::string& types) {
        const std::string text = R"({"info": {}, "errors": {}, "path_parameters": {}, "routes": {"session": {)" +
                                 route + R"(}}, "types": {"messages": {)" + types + R"(}}, "unions": {}})";
        const auto all = serve::read_protocol(text);
        return all ? std::string() : all.error().message;
    };
    const std::string state = R"("GET /api/state": {"does": "State", "who": "viewer", "answer": "State"})";
    EXPECT_EQ(read(state, R"("State": {"fields": {"time_s": "number"}})"), "");
    EXPECT_EQ(read(state, ""), "the type State is not described");
    EXPECT_EQ(read(state, R"("State": {"feilds": {}})"), "State: the key feilds is not known");
    EXPECT_EQ(read(state, R"("State": {"fields": {"at": "Place | null"}})"), "the type Place is not described");
    EXPECT_EQ(read(R"("GET /api/{s}": {"does": "", "who": "viewer", "answer": "object"})", ""),
              "/api/{s}: is not in path_parameters");
    EXPECT_THAT(read(R"("GET /api": {"does": "", "who": "all", "answer": "object"})", ""),
                HasSubstr("who must be one of anyone, trigger"));
}

}  // namespace
}  // namespace talus::test
