#pragma once

#include <gmock/gmock.h>

/// What tests of notes and refusals say of texts.
namespace talus::scene {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

}  // namespace talus::scene
