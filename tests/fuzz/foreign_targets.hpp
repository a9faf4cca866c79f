#pragma once

#include <string>

/// Targets that take untrusted files: beside what every target requires, no file outside their folder is opened and
/// no connection made, by this process or the one that reads for it (support/witness.hpp).
namespace talus::fuzz {

/// "ROLE NAME" on the first line, the file after it: "terrain dem.asc".
bool upload(const std::string& bytes);
/// The scene file of a bundle with a terrain dem.tif, a layer release.geojson and a mesh houses.obj.
bool bundle(const std::string& bytes);
bool session_file(const std::string& bytes);
/// The bodies by which a terrain is mended and a new scene is made of it.
bool draft_setup(const std::string& bytes);

}  // namespace talus::fuzz
