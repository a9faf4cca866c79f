#pragma once

#include "call.hpp"
#include "core/grid.hpp"
#include "core/result.hpp"
#include "core/try.hpp"
#include "handle.hpp"
#include "talus.h"

// What the files that read a simulation call by its short name, beside functions of C outside any namespace. For those
// files alone.
using talus::Error;
using talus::Grid;
using talus::GridGeometry;
using talus::Result;
using talus::Status;
using talus::embed::Answers;
using talus::embed::buffer_of;
using talus::embed::check_size;
using talus::embed::give;
using talus::embed::guarded;
using talus::embed::need;
using talus::twin::Scenario;
