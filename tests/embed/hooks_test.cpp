// The log and the allocator of the program. Each test takes its hooks away again: they are the whole program's.
#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "embed_fixtures.hpp"

namespace talus::embed::test {
namespace {

/// Keeps what is told.
struct Log {
    std::vector<std::pair<int, std::string>> told{};
    talus_log hook{sizeof(talus_log), &Log::write, this, TALUS_LOG_INFO};

    explicit Log(int least_level = TALUS_LOG_INFO) {
        hook.least_level = least_level;
        EXPECT_EQ(talus_set_log(&hook, nullptr), TALUS_OK);
    }
    ~Log() { EXPECT_EQ(talus_set_log(nullptr, nullptr), TALUS_OK); }
    Log(const Log&) = delete;
    Log& operator=(const Log&) = delete;

    static void write(void* user, int level, const char* sentence) {
        static_cast<Log*>(user)->told.emplace_back(level, sentence);
    }
    [[nodiscard]] bool has(int level, const std::string& part) const {
        for (const auto& [each, sentence] : told) {
            if (each == level && sentence.find(part) != std::string::npos) return true;
        }
        return false;
    }
};

TEST(Log, tells_what_was_opened_changed_and_refused) {
    talus_error error = TALUS_SIZED(talus_error);
    Log log;
    const Simulation simulation = Slope().open();
    EXPECT_TRUE(log.has(TALUS_LOG_INFO, "opened \"from arrays\" at t = 0 s"));
    EXPECT_TRUE(log.has(TALUS_LOG_WARNING, "flow path")) << "it was traced, and the program should know";
    ASSERT_EQ(talus_set(simulation.get(), "material.friction_coefficient", 2, &error), TALUS_OK) << error.text;
    EXPECT_TRUE(log.has(TALUS_LOG_INFO, "friction"));
    EXPECT_EQ(talus_set(simulation.get(), "material.friction_coefficient", -1, &error), TALUS_BAD_INPUT);
    EXPECT_TRUE(log.has(TALUS_LOG_ERROR, error.text)) << "the same sentence";
    EXPECT_EQ(talus_step(nullptr, 1, nullptr, nullptr), TALUS_BAD_INPUT);
    EXPECT_TRUE(log.has(TALUS_LOG_ERROR, "simulation is NULL")) << "also without an error to write into";
    advance_to(simulation, 1e9);
    EXPECT_TRUE(log.has(TALUS_LOG_INFO, state_of(simulation).message));
}

TEST(Log, tells_no_less_than_is_wanted_and_nothing_after_it_is_taken_away) {
    Log all;
    {
        const Log errors(TALUS_LOG_ERROR);
        const Simulation simulation = Slope().open();
        EXPECT_TRUE(errors.told.empty());
        EXPECT_EQ(talus_step(nullptr, 1, nullptr, nullptr), TALUS_BAD_INPUT);
        EXPECT_EQ(errors.told.size(), 1U);
    }
    EXPECT_EQ(talus_step(nullptr, 1, nullptr, nullptr), TALUS_BAD_INPUT);
    EXPECT_TRUE(all.told.empty()) << "the second log took its place";
}

TEST(Log, is_refused_without_a_function_a_size_or_a_level) {
    talus_error error = TALUS_SIZED(talus_error);
    talus_log log = TALUS_SIZED(talus_log);
    EXPECT_EQ(talus_set_log(&log, &error), TALUS_BAD_INPUT);
    EXPECT_STREQ(error.text, "log.write is NULL");
    log.write = &Log::write;
    log.least_level = 3;
    EXPECT_EQ(talus_set_log(&log, &error), TALUS_BAD_INPUT);
    EXPECT_STREQ(error.text, "log.least_level = 3: must be TALUS_LOG_INFO, 0, to TALUS_LOG_ERROR, 2");
    log.size = 1;
    EXPECT_EQ(talus_set_log(&log, &error), TALUS_BAD_INPUT);
    EXPECT_NE(std::string(error.text).find("log.size = 1"), std::string::npos) << error.text;
}

/// Counts, and knows its blocks.
struct Allocator {
    std::mutex mutex{};
    std::map<void*, std::size_t> blocks{};
    std::size_t made = 0;
    bool empty = false;  ///< there is no memory left
    talus_allocator hook{sizeof(talus_allocator), &Allocator::allocate, &Allocator::release, this};

    Allocator() { EXPECT_EQ(talus_set_allocator(&hook, nullptr), TALUS_OK); }
    ~Allocator() {
        take_away();
        EXPECT_TRUE(blocks.empty()) << blocks.size() << " blocks were not given back";
    }
    Allocator(const Allocator&) = delete;
    Allocator& operator=(const Allocator&) = delete;
    static void take_away() { EXPECT_EQ(talus_set_allocator(nullptr, nullptr), TALUS_OK); }

    static void* allocate(void* user, std::size_t bytes, std::size_t alignment) {
        auto& self = *static_cast<Allocator*>(user);
        const std::scoped_lock lock(self.mutex);
        if (self.empty) return nullptr;
        void* const block = std::aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment);
        self.blocks[block] = bytes;
        ++self.made;
        return block;
    }
    static void release(void* user, void* block, std::size_t bytes, std::size_t alignment) {
        auto& self = *static_cast<Allocator*>(user);
        const std::scoped_lock lock(self.mutex);
        const auto found = self.blocks.find(block);
        ASSERT_NE(found, self.blocks.end()) << "it is not a block of this allocator";
        EXPECT_EQ(found->second, bytes);
        EXPECT_EQ(reinterpret_cast<std::uintptr_t>(block) % alignment, 0U);
        self.blocks.erase(found);
        std::free(block);
    }
    [[nodiscard]] bool owns(const void* array) {
        const std::scoped_lock lock(mutex);
        return blocks.contains(const_cast<void*>(array));
    }
};

TEST(Allocator, has_all_arrays_that_are_made_to_be_handed_out) {
    Allocator allocator;
    talus_error error = TALUS_SIZED(talus_error);
    const Simulation simulation = Slope().open();
    ASSERT_EQ(talus_step(simulation.get(), 5, nullptr, &error), TALUS_OK);
    advance_to(simulation, 0.987);
    EXPECT_EQ(allocator.made, 0U) << "steps take memory of C++";
    talus_map map = TALUS_SIZED(talus_map), fixed = map;
    talus_front front = TALUS_SIZED(talus_front);
    talus_debris debris = TALUS_SIZED(talus_debris);
    talus_surface surface = TALUS_SIZED(talus_surface);
    const talus_grid grid{0, 0, 5, 12, 6};
    ASSERT_EQ(talus_get_map(simulation.get(), "depth", &map, &error), TALUS_OK);
    ASSERT_EQ(talus_get_map_on(simulation.get(), "depth", &grid, &fixed, &error), TALUS_OK);
    ASSERT_EQ(talus_get_front(simulation.get(), &front, &error), TALUS_OK);
    ASSERT_GT(front.count, 0U);
    ASSERT_EQ(talus_get_debris_at(simulation.get(), 0.987, &debris, &error), TALUS_OK) << error.text;
    ASSERT_EQ(talus_get_surface(simulation.get(), &surface, &error), TALUS_OK);
    for (const void* array : {static_cast<const void*>(map.values), static_cast<const void*>(fixed.values),
                              static_cast<const void*>(front.chainage), static_cast<const void*>(front.arrival_time),
                              static_cast<const void*>(front.velocity), static_cast<const void*>(debris.x),
                              static_cast<const void*>(debris.velocity_z), static_cast<const void*>(surface.positions),
                              static_cast<const void*>(surface.normals), static_cast<const void*>(surface.depth),
                              static_cast<const void*>(surface.speed), static_cast<const void*>(surface.indices)}) {
        EXPECT_TRUE(allocator.owns(array));
    }
    EXPECT_FALSE(allocator.owns(debris_of(simulation).x)) << "the solver's own memory";
    ASSERT_EQ(talus_step(simulation.get(), 1, nullptr, &error), TALUS_OK);
    EXPECT_TRUE(allocator.blocks.empty()) << "what a step makes invalid is given back";
}

TEST(Allocator, gets_back_what_it_gave_after_another_took_its_place) {
    Allocator allocator;
    talus_map map = TALUS_SIZED(talus_map);
    const Simulation simulation = Slope().open();
    ASSERT_EQ(talus_get_map(simulation.get(), "depth", &map, nullptr), TALUS_OK);
    EXPECT_EQ(allocator.blocks.size(), 1U);
    Allocator::take_away();
    ASSERT_EQ(talus_get_map(simulation.get(), "peak_depth", &map, nullptr), TALUS_OK);
    EXPECT_EQ(allocator.made, 1U);
    ASSERT_EQ(talus_step(simulation.get(), 1, nullptr, nullptr), TALUS_OK);
    EXPECT_TRUE(allocator.blocks.empty());
}

TEST(Allocator, that_has_none_left_is_a_failure_of_the_machine) {
    Allocator allocator;
    const Simulation simulation = Slope().open();
    const std::uint64_t hash = hash_of(simulation);
    talus_error error = TALUS_SIZED(talus_error);
    talus_map map = TALUS_SIZED(talus_map);
    allocator.empty = true;
    EXPECT_EQ(talus_get_map(simulation.get(), "depth", &map, &error), TALUS_FAILURE);
    EXPECT_STREQ(error.text, "out of memory");
    allocator.empty = false;
    EXPECT_EQ(talus_get_map(simulation.get(), "depth", &map, &error), TALUS_OK) << "it goes on when there is some";
    EXPECT_EQ(hash_of(simulation), hash);
}

TEST(Allocator, is_refused_without_its_functions_or_its_size) {
    talus_error error = TALUS_SIZED(talus_error);
    talus_allocator allocator = TALUS_SIZED(talus_allocator);
    EXPECT_EQ(talus_set_allocator(&allocator, &error), TALUS_BAD_INPUT);
    EXPECT_STREQ(error.text, "allocator.allocate is NULL");
    allocator.allocate = &Allocator::allocate;
    EXPECT_EQ(talus_set_allocator(&allocator, &error), TALUS_BAD_INPUT);
    EXPECT_STREQ(error.text, "allocator.release is NULL");
    allocator.size = 8;
    EXPECT_EQ(talus_set_allocator(&allocator, &error), TALUS_BAD_INPUT);
    EXPECT_NE(std::string(error.text).find("allocator.size = 8"), std::string::npos) << error.text;
}

}  // namespace
}  // namespace talus::embed::test
