#pragma once

#include <cstddef>
#include <vector>

/// Wall time left of the runs of a command.
namespace talus::run {

/// Less done than this, and nothing is said of what is left: what a run begins with, such as the reading of files and
/// the first short steps, says little of the rest.
constexpr double least_share_done = 0.01;

/// `left`, s, after `elapsed` s of wall time; NaN where less than least_share_done is done.
[[nodiscard]] double told_left(double elapsed, double left);

/// Wall time left of several runs, `at_once` of them at a time. Each run under way says how much of it is left, as
/// `talus run` does (RunClock). A run that has not begun takes as long as the mean of those that have, times its
/// effort. Time is any wall clock in s; that of the first begin is the zero of what has elapsed.
class WorkClock {
  public:
    /// `efforts`: wall times of the runs over each other, in the order in which they begin; a run beyond them has 1.
    explicit WorkClock(const std::vector<double>& efforts, int at_once = 1);

    /// An earlier call made this run in `wall_time` s.
    void found(std::size_t run, double wall_time);
    void begin(std::size_t run, double now);
    /// `remaining`: s, of this run; NaN: it does not know yet.
    void tick(std::size_t run, double now, double remaining);
    void end(std::size_t run, double now);

    /// s; NaN: nothing is known of it. Of a run that says nothing and takes longer than the others nothing is known.
    [[nodiscard]] double left(double now) const;
    [[nodiscard]] double elapsed(double now) const;  ///< s, 0 before the first begin
    [[nodiscard]] double wall_remaining(double now) const { return told_left(elapsed(now), left(now)); }
    [[nodiscard]] double share_done(double now);  ///< 0 to 1, never falls

  private:
    enum class Phase { waiting, under_way, over };
    struct Piece {
        double effort = 1;
        Phase phase = Phase::waiting;
        double begun = 0, end = 0;  // s; the end of a run under way as it says, NaN: it does not
    };
    [[nodiscard]] double unit() const;
    [[nodiscard]] Piece& piece(std::size_t run);

    std::vector<Piece> pieces_;
    int at_once_;
    double start_;                                  // NaN: none has begun
    double earlier_time_ = 0, earlier_effort_ = 0;  // of an earlier call's runs
    double share_done_ = 0;
};

}  // namespace talus::run
