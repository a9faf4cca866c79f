// The corpus and inputs made from it, in the ordinary build. scripts/fuzz.sh looks for new ones.
#include <algorithm>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "support/fixtures.hpp"
#include "targets.hpp"

namespace talus::fuzz {
namespace {

/// Bytes, bits, cuts, repeats, and numbers and words that parsers stumble over.
std::string changed(std::string bytes, std::mt19937& random) {
    const auto below = [&](std::size_t limit) {
        return static_cast<std::size_t>(random() % std::max<std::size_t>(1, limit));
    };
    static const std::vector<std::string> words = {
        "1e308", "-1e308", "1e-320", "nan", "-1", "4294967296", "9999999999999999999", "null", "[]", "{}",
        "\"\"",  "[[",     "true",   "\n",  ",",  "\xff",       "\xe2\x80\xae",        "%00"};
    for (std::size_t n = below(4) + 1; n > 0 && !bytes.empty(); --n) {
        const std::size_t at = below(bytes.size());
        switch (below(7)) {
            case 0:
                bytes[at] = static_cast<char>(random());
                break;
            case 1:
                bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(8)));
                break;
            case 2:
                bytes.erase(at, below(20) + 1);
                break;
            case 3:
                bytes.insert(at, bytes.substr(below(bytes.size()), below(100)));
                break;
            case 4:
                bytes.resize(at);
                break;
            case 5:
                bytes.insert(at, words[below(words.size())]);
                break;
            default: {  // in place of a number
                const std::size_t digit = bytes.find_first_of("0123456789", at);
                if (digit == std::string::npos) break;
                const std::size_t end = std::min(bytes.find_first_not_of("0123456789.eE+-", digit), bytes.size());
                bytes.replace(digit, end - digit, words[below(7)]);
            }
        }
    }
    return bytes;
}

class Corpus : public testing::TestWithParam<Target> {};

TEST_P(Corpus, and_what_is_made_from_it_is_read_or_refused) {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(TALUS_SOURCE_DIR) /
                                                                 "tests/fuzz/corpus" / GetParam().name)) {
        files.push_back(entry.path());
    }
    ASSERT_FALSE(files.empty());
    std::sort(files.begin(), files.end());
    const std::string name = GetParam().name;
    // Per file; those that start a process for each input are slow.
    const int rounds = name == "upload"                                                  ? 6
                       : name == "bundle"                                                ? 15
                       : name == "actions" || name == "draft_setup"                      ? 40
                       : name == "http" || name == "websocket" || name == "session_file" ? 50
                                                                                         : 400;
    std::mt19937 random(20);
    int accepted = 0;
    for (const auto& file : files) {
        const std::string bytes = test::read_text(file);
        accepted += GetParam().run(bytes) ? 1 : 0;
        for (int k = 0; k < rounds; ++k) {
            const std::string input = changed(bytes, random);
            test::write_text((std::filesystem::path(testing::TempDir()) / ("fuzz-" + name)).string(),
                             input);  // it stays after a crash
            (void)GetParam().run(input);
        }
    }
    EXPECT_GT(accepted, 0) << "what is refused at once leads nowhere";
}

INSTANTIATE_TEST_SUITE_P(Fuzz, Corpus, testing::ValuesIn(targets().begin(), targets().end()),
                         [](const auto& given) { return std::string(given.param.name); });

}  // namespace
}  // namespace talus::fuzz
