#include "pack/write.hpp"

#include <new>
#include <zlib.h>

namespace talus::pack {

// Apart, since a page's engine only reads.
std::string write(const Packed& packed) {
    const std::string content = write_content(packed);
    uLong size = compressBound(content.size());
    std::string deflated(size, '\0');
    const int result = compress2(reinterpret_cast<Bytef*>(deflated.data()), &size,
                                 reinterpret_cast<const Bytef*>(content.data()), content.size(), Z_BEST_COMPRESSION);
    if (result != Z_OK) throw std::bad_alloc();  // the only reason with a buffer of that size
    deflated.resize(size);
    return enclose(content, deflated);
}

}  // namespace talus::pack
