#include "twin/frame.hpp"

#include <cstring>
#include <zlib.h>

#include <gmock/gmock.h>

#include "core/byte_planes.hpp"
#include "twin/recording.hpp"
#include "twin_fixtures.hpp"

namespace talus::twin::test {
namespace {

/// What docs/protocol.md says, read by that alone.
struct Decoded {
    std::string magic;
    int version = 0, scenario = 0, flags = 0;
    double time = 0;
    std::uint64_t step = 0;
    std::uint32_t slots = 0, stride = 0;
    std::array<std::vector<int>, 3> place;        // as stored
    std::array<std::vector<double>, 3> position;  // m
    std::vector<double> speed;                    // m/s
    std::array<std::uint32_t, 4> window{};
    std::vector<double> depth, depth_speed;
    std::array<float, 3> unit{};
    float depth_unit = 0;
};

template <class T>
T at(const std::string& bytes, std::size_t offset) {
    T value{};
    std::memcpy(&value, bytes.data() + offset, sizeof value);
    return value;
}

std::vector<int> unfold(const std::vector<std::uint8_t>& body, std::size_t& at, std::size_t n) {
    std::vector<int> values(n);
    int before = 0;
    for (std::size_t k = 0; k < n; ++k) {
        const int folded = body[at + k] + 256 * body[at + n + k];
        const int difference = folded % 2 == 0 ? folded / 2 : -(folded + 1) / 2;
        before = (before + difference + 65536) % 65536;
        values[k] = before;
    }
    at += 2 * n;
    return values;
}

Decoded decode(const std::string& bytes) {
    Decoded d;
    d.magic = bytes.substr(0, 4);
    d.version = at<std::uint8_t>(bytes, 4);
    d.scenario = at<std::uint8_t>(bytes, 5);
    d.flags = at<std::uint16_t>(bytes, 6);
    d.time = at<double>(bytes, 8);
    d.step = at<std::uint64_t>(bytes, 16);
    d.slots = at<std::uint32_t>(bytes, 24);
    d.stride = at<std::uint32_t>(bytes, 28);
    const auto zero = at<std::array<float, 3>>(bytes, 32);
    d.unit = at<std::array<float, 3>>(bytes, 44);
    const auto speed_unit = at<float>(bytes, 56);
    d.window = at<std::array<std::uint32_t, 4>>(bytes, 60);
    d.depth_unit = at<float>(bytes, 76);
    const auto depth_speed_unit = at<float>(bytes, 80);
    std::vector<std::uint8_t> body(at<std::uint32_t>(bytes, 84));
    uLongf size = body.size();
    EXPECT_EQ(uncompress(body.data(), &size, reinterpret_cast<const Bytef*>(bytes.data() + 88), bytes.size() - 88),
              Z_OK);
    EXPECT_EQ(size, body.size());
    const std::size_t n = (d.slots + d.stride - 1) / d.stride, m = std::size_t{d.window[2]} * d.window[3];
    EXPECT_EQ(body.size(), 7 * n + 3 * m);
    std::size_t offset = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        d.place[axis] = unfold(body, offset, n);
        for (const int p : d.place[axis]) d.position[axis].push_back(double{zero[axis]} + p * double{d.unit[axis]});
    }
    for (std::size_t k = 0; k < n; ++k) d.speed.push_back(body[offset + k] * double{speed_unit});
    offset += n;
    for (const int depth : unfold(body, offset, m)) d.depth.push_back(depth * double{d.depth_unit});
    for (std::size_t k = 0; k < m; ++k) d.depth_speed.push_back(body[offset + k] * double{depth_speed_unit});
    return d;
}

/// 500 particles in two thirds of the ids, anyhow.
sim::State scattered() {
    sim::State state;
    state.resize(500);
    state.count = 500;
    state.time = 12.5;
    state.step = 777;
    std::uint32_t noise = 1;
    const auto random = [&] { return static_cast<float>((noise = noise * 1664525U + 1013904223U) >> 8) / 16777216.0F; };
    for (std::uint32_t i = 0; i < state.count; ++i) {
        state.id[i] = (i * 251 % 500) * 3 / 2;
        state.position.set(i, {-300 + 700 * random(), 250 * random(), 80 * random()});
        state.velocity.set(i, {10 * random(), 0, -3 * random()});
    }
    return state;
}

TEST(Frame, says_where_every_particle_is_to_half_a_unit) {
    const sim::State state = scattered();
    const std::string bytes = encode(make_frame(state, {}, 750, 1, frame_running), 1, frame_recorded);
    const Decoded d = decode(bytes);
    EXPECT_EQ(d.magic, "TLSF");
    EXPECT_EQ(d.version, 1);
    EXPECT_EQ(d.scenario, 1);
    EXPECT_EQ(d.flags, 5);
    EXPECT_EQ(d.time, 12.5);
    EXPECT_EQ(d.step, 777U);
    ASSERT_EQ(d.speed.size(), 750U);
    std::vector<bool> there(750);
    for (std::uint32_t i = 0; i < state.count; ++i) {
        const std::uint32_t id = state.id[i];
        there[id] = true;
        EXPECT_NEAR(d.position[0][id], state.position.x[i], 0.51 * d.unit[0] + 1e-4);
        EXPECT_NEAR(d.position[1][id], state.position.y[i], 0.51 * d.unit[1] + 1e-4);
        EXPECT_NEAR(d.position[2][id], state.position.z[i], 0.51 * d.unit[2] + 1e-4);
        EXPECT_NEAR(d.speed[id], length(state.velocity.at(i)), 11.0 / 255);
    }
    EXPECT_LT(d.unit[0], 700.5 / 65534);
    for (std::size_t id = 0; id < 750; ++id) {
        const bool absent = d.place[0][id] == 65535 && d.place[1][id] == 65535 && d.place[2][id] == 65535;
        EXPECT_EQ(absent, !there[id]) << id;
    }
}

TEST(Frame, with_a_stride_has_every_so_many_ids) {
    const sim::State state = scattered();
    const Decoded all = decode(encode(make_frame(state, {}, 750, 1, 0), 0)),
                  some = decode(encode(make_frame(state, {}, 750, 4, 0), 0));
    ASSERT_EQ(some.speed.size(), 188U);
    for (std::size_t k = 0; k < some.speed.size(); ++k) EXPECT_EQ(some.place[0][k], all.place[0][4 * k]);
}

TEST(Frame, without_particles_is_one_too) {
    const Decoded d = decode(encode(make_frame(sim::State{}, {}, 0, 1, 0), 0));
    EXPECT_EQ(d.slots, 0U);
    EXPECT_EQ(d.window[2], 0U);
}

TEST(Frame, of_a_scenario_holds_depths_that_add_up_to_its_debris) {
    const auto scenario = open(channel_scene());
    run_until(*scenario, 2);
    const Decoded d = decode(encode(*scenario->run().frame(1, frame_running), 0));
    EXPECT_EQ(d.time, scenario->time());
    const json map = scene_json(*scenario)["map"];
    const double cell = map["cell_m"];
    double volume = 0, fastest = 0;
    for (const double depth : d.depth) volume += depth * cell * cell;
    for (const double speed : d.depth_speed) fastest = std::max(fastest, speed);
    EXPECT_NEAR(volume, number(*scenario, "volume_released_m3"), 0.01 * volume);
    EXPECT_GT(fastest, 1);
    EXPECT_LE(fastest, number(*scenario, "largest_speed_mps") * 1.01);
    // The particles lie where the depths are.
    const json origin = scene_json(*scenario)["origin"];
    for (std::size_t id = 0; id < d.speed.size(); ++id) {
        const double x = d.position[0][id] + origin[0].get<double>() - map["x_min_m"].get<double>();
        const double y = d.position[1][id] + origin[1].get<double>() - map["y_min_m"].get<double>();
        const auto column = static_cast<std::uint32_t>(x / cell) - d.window[0],
                   row = static_cast<std::uint32_t>(y / cell) - d.window[1];
        ASSERT_LT(column, d.window[2]);
        ASSERT_LT(row, d.window[3]);
        EXPECT_GT(d.depth[std::size_t{row} * d.window[2] + column], 0);
    }
}

TEST(Recording, is_of_even_times_and_can_be_looked_up) {
    const auto scenario = open(channel_scene());
    run_until(*scenario, 2);
    const json recording = recording_json(*scenario);
    ASSERT_EQ(recording["times_s"].size(), 21U);
    for (int k = 0; k <= 20; ++k) {
        EXPECT_GE(recording["times_s"][k].get<double>(), 0.1 * k - 1e-8);
        EXPECT_LT(recording["times_s"][k].get<double>(), 0.1 * k + 1.0 / 60);
    }
    const Decoded d = decode(encode(*scenario->run().recording().at(1.05), 0, frame_recorded));
    EXPECT_EQ(d.time, recording["times_s"][10]);
    EXPECT_EQ(d.flags & 4, 4);
    EXPECT_EQ(scenario->run().recording().at(-1), nullptr);
}

TEST(Recording, thins_out_its_older_half_when_full) {
    Recording recording(0.1, 20 * sizeof(Frame));
    for (int k = 0; k < 200; ++k) {
        Frame frame;
        frame.time = 0.1 * k;
        ASSERT_TRUE(recording.due(frame.time));
        recording.add(std::make_shared<const Frame>(frame));
        ASSERT_FALSE(recording.due(frame.time + 0.05));
        ASSERT_LE(recording.bytes(), 20 * sizeof(Frame));
        ASSERT_EQ(recording.bytes(), recording.frames().size() * sizeof(Frame));
    }
    EXPECT_EQ(recording.frames().front()->time, 0);
    EXPECT_GE(recording.frames().size(), 10U);
    const std::size_t last = recording.frames().size() - 1;
    for (std::size_t k = last; k > last - 4; --k) {
        EXPECT_NEAR(recording.frames()[k]->time - recording.frames()[k - 1]->time, 0.1, 1e-9) << "of late";
    }
    EXPECT_EQ(recording.at(1e9), recording.frames().back());
    EXPECT_EQ(recording.until(1e9), recording.frames());
    EXPECT_EQ(recording.until(-1).size(), 0U);
}

TEST(Probe, reads_depth_speed_and_pressure_from_the_recording) {
    const auto scenario = open(channel_scene());
    const PlanPoint p{west + 30.5, south + 30.5};
    run_until(*scenario, 4);
    const json probe = probe_at(*scenario, p)();
    ASSERT_EQ(probe["time_s"].size(), recording_json(*scenario)["times_s"].size());
    EXPECT_EQ(probe["depth_m"][0], 0);
    double deepest = 0, fastest = 0;
    for (std::size_t k = 0; k < probe["time_s"].size(); ++k) {
        const double speed = probe["speed_mps"][k];
        deepest = std::max(deepest, probe["depth_m"][k].get<double>());
        fastest = std::max(fastest, speed);
        EXPECT_NEAR(probe["pressure_kPa"][k].get<double>(), 2 * speed * speed, 1e-9);
    }
    // The peaks see every step, the recording every sixth or so.
    const Grid<float> depth = (*layer_of(*scenario, "peak_depth"))(), speed = (*layer_of(*scenario, "peak_speed"))();
    const auto column = static_cast<int>((p.x - depth.geometry.x_min) / depth.geometry.cell),
               row = static_cast<int>((p.y - depth.geometry.y_min) / depth.geometry.cell);
    EXPECT_GT(deepest, 0.1);
    EXPECT_NEAR(deepest, depth.at(column, row), 0.15 * deepest);
    EXPECT_NEAR(fastest, speed.at(column, row), 0.2 * fastest);
    EXPECT_EQ(json(probe_at(*scenario, {0, 0})())["depth_m"][5], 0);
}

TEST(Grid, message_is_as_the_protocol_says) {
    Grid<float> grid(GridGeometry{west, south, 2.5, 3, 2});
    grid.values = {1, 2, 3, 4, 5, NAN};
    const std::string bytes = encode_grid(grid);
    EXPECT_EQ(bytes.substr(0, 4), "TLSG");
    EXPECT_EQ((at<std::array<std::uint8_t, 4>>(bytes, 4)), (std::array<std::uint8_t, 4>{2, 0, 0, 0}));
    EXPECT_EQ((at<std::array<double, 3>>(bytes, 8)), (std::array<double, 3>{west, south, 2.5}));
    EXPECT_EQ((at<std::array<std::uint32_t, 2>>(bytes, 32)), (std::array<std::uint32_t, 2>{3, 2}));
    std::array<float, 6> values{};
    uLongf size = sizeof values;
    EXPECT_EQ(at<std::uint32_t>(bytes, 40), size);
    ASSERT_EQ(uncompress(reinterpret_cast<Bytef*>(values.data()), &size,
                         reinterpret_cast<const Bytef*>(bytes.data() + 44), bytes.size() - 44),
              Z_OK);
    EXPECT_EQ(values[3], 4);
    EXPECT_TRUE(std::isnan(values[5]));

    const std::string smooth = encode_grid(grid, GridCoding::differences);
    EXPECT_EQ((at<std::array<std::uint8_t, 4>>(smooth, 4)), (std::array<std::uint8_t, 4>{2, 1, 0, 0}));
    EXPECT_EQ(smooth.substr(8, 36), bytes.substr(8, 36));
    std::string planes(sizeof values, '\0');
    size = planes.size();
    ASSERT_EQ(uncompress(reinterpret_cast<Bytef*>(planes.data()), &size,
                         reinterpret_cast<const Bytef*>(smooth.data() + 44), smooth.size() - 44),
              Z_OK);
    const std::vector<float> again = from_difference_planes(planes, 3);
    EXPECT_EQ(again[3], 4);
    EXPECT_TRUE(std::isnan(again[5]));
}

}  // namespace
}  // namespace talus::twin::test
