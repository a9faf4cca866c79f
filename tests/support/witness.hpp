#pragma once

#include <string>
#include <vector>

/// Sees which files this process and its children open, and which connections they make: witness.cpp stands before the
/// C library's own functions, linked into a program or preloaded. What was opened is written to the file that the
/// environment names in WITNESS_LOG. It cannot be seen what a program opens by a call of the kernel's of its own.
namespace talus::test {

class Witness {
  public:
    /// From now on, with a log of its own; one at a time.
    explicit Witness(const std::string& log);
    ~Witness();
    Witness(const Witness&) = delete;
    Witness& operator=(const Witness&) = delete;

    /// Files that were opened outside `folders` and what is installed on every system, and "connect ADDRESS" and the
    /// like, for each that was tried.
    [[nodiscard]] std::vector<std::string> elsewhere(const std::vector<std::string>& folders) const;
    /// All of them.
    [[nodiscard]] std::vector<std::string> lines() const;

  private:
    std::string log_;
};

}  // namespace talus::test
