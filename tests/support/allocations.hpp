#pragma once

namespace talus::test {

/// How often this program has called operator new.
long allocation_count();

}  // namespace talus::test
