#include "sim/simulation.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <mutex>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/hash.hpp"
#include "sim/backend_choice.hpp"
#include "sim/change.hpp"
#include "sim/fault.hpp"
#include "sim/particle_density.hpp"
#include "sim/step.hpp"
#include "sim/time_step.hpp"
#include "simd/parallel.hpp"

namespace talus::sim {

/// The parts of a step other than moving particles.
struct Simulation::StepHooks {
    Simulation& self;
    StepWatcher* watcher;

    void inject_inflow() const {
        self.inject_inflow(watcher);
        self.hand_over();
    }
    void choose_time_step() const {
        self.state_.time_step = sim::choose_time_step(self.model_, self.state_);
        raise_water(self.model_, self.state_, [&](std::uint32_t first, std::uint32_t last) {
            return self.device_ != nullptr ? self.device_->sum_places(self.state_, first, last)
                                           : sum_places(self.state_, first, last);
        });
    }
    [[nodiscard]] Status check_faults() const {
        return find_fault(self.model_, self.state_, self.highest_energy_head_);
    }
    [[nodiscard]] Status entrain_bed() const { return self.entrain_bed(); }
    void observe() const {
        if (watcher == nullptr) return;
        if (self.on_device() && watcher->observe_on(*self.device_, self.model_, self.ground_, self.state_)) return;
        watcher->observe(self.model_, self.ground_, self.state());
    }
    void remove_failed() const {
        if (watcher == nullptr) return;
        for (const std::size_t building : watcher->failed_buildings()) {
            self.fetch();
            remove_building(self.model_, self.ground_, self.state_, building);
            self.follow_change();
        }
    }
};

Simulation::Simulation(Model model, Ground ground, State state, InflowFeeder inflow)
    : model_(std::move(model)),
      ground_(std::move(ground)),
      state_(std::move(state)),
      inflow_(std::move(inflow)),
      expected_(inflow_.remaining()),
      capacity_(state_.count + expected_),
      backend_(settled_backend(model_.solver.backend, capacity_)),
      highest_energy_head_(std::numeric_limits<double>::lowest()) {
    if (expected_ > 0) state_.resize(capacity_);
    make_device();
    if (device_ == nullptr) processor_.emplace(model_, capacity_);
    measure_energy_and_speed();
}

/// If the backend is one.
void Simulation::make_device() {
    if (backend_ == params::BackendChoice::cuda) device_ = device::make_cuda_backend();
    if (backend_ == params::BackendChoice::host) device_ = device::make_host_backend();
}

Simulation::Simulation(const Simulation& other)
    : model_(other.model_),
      ground_(other.ground_),
      state_(other.state()),
      kept_(other.kept_on_device_ ? state_ : other.kept_),
      inflow_(other.inflow_),
      expected_(other.expected_),
      capacity_(other.capacity_),
      backend_(other.backend_),
      entrainment_(other.entrainment_),
      times_(other.times_),
      highest_energy_head_(other.highest_energy_head_) {
    make_device();
    state_.building_contacts.reserve(other.state_.building_contacts.capacity());
}

std::unique_lock<std::mutex> Simulation::lock_device() const {
    return device_ != nullptr ? std::unique_lock(*device_lock_) : std::unique_lock<std::mutex>();
}

/// Copies the particles back if a step has moved them on a device.
void Simulation::fetch() const {
    const auto lock = lock_device();
    if (std::exchange(device_is_newer_, false)) device_->fetch(state_);
}

/// Before the stages of a step.
void Simulation::hand_over() {
    if (device_ == nullptr) return;
    if (std::exchange(device_is_older_, false)) {
        make_room_for_soil(model_, state_);
        device_->follow(model_, ground_, state_);
    }
    if (!std::exchange(device_is_newer_, true)) last_read_ = state_;
}

void Simulation::keep() {
    kept_on_device_ = device_is_newer_;
    if (!kept_on_device_) {
        kept_ = state_;
        return;
    }
    kept_.resize(state_.room());
    static_cast<StateSummary&>(kept_) = state_;
    device_->keep(state_);
}

const State& Simulation::kept() {
    if (std::exchange(kept_on_device_, false)) {
        try {
            device_->fetch_kept(kept_);
        } catch (const device::DeviceFailure&) {
            kept_.count = 0;
        }
    }
    return kept_;
}

Motion Simulation::motion(double deposited_speed) const {
    const auto lock = lock_device();
    if (device_is_newer_) return device_->count_motion(state_, MotionCount(deposited_speed));
    return motion_of(state_, deposited_speed);
}

std::string Simulation::instruction_set() const {
    if (device_ != nullptr) return device_->name();
    return std::string(processor_ ? processor_->instruction_set()
                                  : cpu::particle_stages_for(model_.solver.kernel).instruction_set);
}

double Simulation::mean_neighbours() const {
    const auto lock = lock_device();
    if (device_ != nullptr) return device_->mean_neighbours();
    if (!processor_) return 0;
    double pairs = 0;
    for (std::uint32_t i = 0; i < state_.count; ++i) pairs += processor_->neighbours().count_of(i);
    return state_.count > 0 ? pairs / state_.count : 0;
}

device::Traffic Simulation::device_traffic() const {
    const auto lock = lock_device();
    return device_ != nullptr ? device_->traffic() : device::Traffic{};
}

std::size_t Simulation::device_bytes() const {
    const auto lock = lock_device();
    return device_ != nullptr ? device_->bytes() : 0;
}

void Simulation::measure_energy_and_speed() {
    for (std::uint32_t i = 0; i < state_.count; ++i) {
        const LocalPoint v = state_.velocity.at(i);
        highest_energy_head_ = std::max(highest_energy_head_, state_.position.z[i] + dot(v, v) / (2 * model_.gravity));
        state_.max_speed = std::max<double>(state_.max_speed, length(v));
    }
    state_.building_contacts.reserve((face_count - 1) * std::max(state_.count, capacity_));
}

Status Simulation::advance(StepWatcher* watcher) {
    const StepHooks own{*this, watcher};
    if (device_ == nullptr) {
        if (!processor_) processor_.emplace(model_, capacity_);
        return step(*processor_, model_, ground_, state_, times_, own);
    }
    try {
        return step(*device_, model_, ground_, state_, times_, own);
    } catch (const device::DeviceFailure& failure) {
        const double time = state_.time;
        // What it holds is lost; the state is as it was last read.
        if (std::exchange(device_is_newer_, false)) static_cast<StateSummary&>(state_) = last_read_;
        return Error{fmt::format("at t = {:.4g} s {}", time, failure.what())};
    }
}

void Simulation::inject_inflow(StepWatcher* watcher) {
    if (!inflow_.due(state_.time)) return;
    fetch();
    const std::uint32_t first = state_.seeded;
    inflow_.inject(model_, ground_, state_);
    follow_change();
    if (watcher != nullptr) watcher->follow_inflow(model_, ground_, state_, first);
}

void Simulation::follow_gauge(std::size_t inflow, const std::vector<params::InflowSample>& hydrograph) {
    inflow_.set_hydrograph(inflow, hydrograph);
    expected_ = inflow_.remaining();
    // With spare capacity: a gauge speaks often, and growing reallocates everything.
    const std::uint32_t count = state_.count + expected_;
    if (count <= capacity_) return;
    fetch();
    make_room(count + count / 2);
    device_is_older_ = true;
}

Status Simulation::entrain_bed() {
    if (ground_.bed.empty()) return {};
    fetch();
    const std::size_t loose = entrainment_.find(model_, ground_, state_);
    if (loose == 0) return {};
    const std::size_t count = state_.count + loose, limit = static_cast<std::size_t>(model_.solver.particle_limit);
    if (count > limit) {
        return Error{fmt::format(
            "at t = {:.4g} s debris has entrained its bed until it has more than solver.particle_limit = {} particles: "
            "raise it, or solver.particle_spacing_m",
            state_.time, limit)};
    }
    // With spare capacity: growing reallocates everything.
    if (count > capacity_) make_room(static_cast<std::uint32_t>(std::min(limit, count + count / 2)));
    entrainment_.apply(model_, ground_, state_);
    device_is_older_ = true;
    return {};
}

void Simulation::make_room(std::uint32_t count) {
    // The backend swaps its arrays with those of the state: both must have the same capacity.
    capacity_ = count;
    state_.resize(capacity_);
    state_.building_contacts.reserve((face_count - 1) * capacity_);
    if (device_ == nullptr) processor_.emplace(model_, capacity_);
}

void Simulation::save(ArchiveWriter& archive) {
    fetch();
    archive(state_, ground_, inflow_, entrainment_, highest_energy_head_);
}

void Simulation::restore(ArchiveReader& archive) {
    archive(state_, ground_, inflow_, entrainment_, highest_energy_head_);
    if (archive.failed() || state_.room() < state_.count) return archive.fail();
    make_room(static_cast<std::uint32_t>(std::max<std::size_t>(capacity_, state_.room())));
    device_is_older_ = true;
    keep();
}

void Simulation::change(const std::function<void(Model&, Ground&, State&)>& edit) {
    fetch();
    edit(model_, ground_, state_);
    follow_change();
}

void Simulation::follow_change() {
    device_is_older_ = true;
    state_.building_contacts.clear();
    if (state_.count > capacity_) make_room(state_.count + expected_);
    measure_energy_and_speed();
}

std::uint64_t hash_state(const State& state) {
    std::vector<std::uint32_t> order(state.count);
    for (std::uint32_t i = 0; i < state.count; ++i) order[i] = i;
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return state.id[a] < state.id[b]; });
    StateHash hash;
    hash.add(&state.time, sizeof state.time);
    for (const std::uint32_t i : order) {
        const std::array<float, 6> values = {state.position.x[i], state.position.y[i], state.position.z[i],
                                             state.velocity.x[i], state.velocity.y[i], state.velocity.z[i]};
        hash.add(&state.id[i], sizeof state.id[i]);
        hash.add(values.data(), sizeof values);
    }
    return hash.value();
}

Motion motion_of(const State& state, double deposited_speed) {
    const MotionCount count(deposited_speed);
    return simd::reduce_ranges(
        state.count, 8192, Motion{},
        [&](std::size_t first, std::size_t last, Motion sum) {
            for (std::size_t i = first; i < last; ++i) sum = sum + count(state.velocity.at(i));
            return sum;
        },
        [](const Motion& a, const Motion& b) { return a + b; });
}

PlaceSum sum_places(const State& state, std::uint32_t first, std::uint32_t last) {
    return simd::reduce_ranges(
        state.count, 8192, PlaceSum{},
        [&](std::size_t begin, std::size_t end, PlaceSum sum) {
            for (std::size_t i = begin; i < end; ++i) {
                if (state.id[i] >= first && state.id[i] < last) sum = sum + PlaceSum::of(state.position.at(i));
            }
            return sum;
        },
        [](const PlaceSum& a, const PlaceSum& b) { return a + b; });
}

double kinetic_energy(const Model& model, const State& state) {
    return model.particle_volume() / 2 *
           simd::reduce_ranges(
               state.count, 4096, 0.0,
               [&](std::size_t first, std::size_t last, double sum) {
                   for (std::size_t i = first; i < last; ++i) {
                       const double x = state.velocity.x[i], y = state.velocity.y[i], z = state.velocity.z[i];
                       sum += (x * x + y * y + z * z) * density_of(model, state, i);
                   }
                   return sum;
               },
               [](double a, double b) { return a + b; });
}

double potential_energy(const Model& model, const State& state) {
    return model.particle_volume() * model.gravity *
           simd::reduce_ranges(
               state.count, 4096, 0.0,
               [&](std::size_t first, std::size_t last, double sum) {
                   for (std::size_t i = first; i < last; ++i) sum += state.position.z[i] * density_of(model, state, i);
                   return sum;
               },
               [](double a, double b) { return a + b; });
}

}  // namespace talus::sim
