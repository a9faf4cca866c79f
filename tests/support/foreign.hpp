#pragma once

#include "geo/foreign.hpp"

namespace talus::test {

/// How the tests have untrusted files read. Sanitizers take terabytes of address space.
inline geo::ForeignReader foreign_reader() {
    geo::ForeignReader reader;
    reader.program = FOREIGN_CHILD;
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    reader.memory = 0;
#endif
    reader.processor_time = std::chrono::seconds(20);
    return reader;
}

}  // namespace talus::test
