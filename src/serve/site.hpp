#pragma once

#include <map>
#include <string>
#include <string_view>

#include "serve/message.hpp"

namespace talus::serve {

/// The page's files, from the program's own memory: there is no path into the file system.
class Site {
  public:
    Site();

    struct File {
        std::string type;
        Bytes content;
        Bytes gzipped;          ///< none: not worth it
        bool for_ever = false;  ///< its name changes with its content
    };
    /// `path`: "/" or "/assets/index-1a2b3c4d.js". None: there is no such file.
    [[nodiscard]] const File* find(std::string_view path) const;

  private:
    std::map<std::string, File, std::less<>> files_;
};

}  // namespace talus::serve
