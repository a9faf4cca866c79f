// What passes faces of the grid.
#include <utility>

#include "depth/solver.hpp"

namespace talus::depth {

void Solver::watch(std::vector<Face> faces) {
    faces_ = std::move(faces);
    passed_.assign(faces_.size(), 0);
    for (std::vector<float>* array : {&passes_east_, &passes_north_})
        array->assign(faces_.empty() ? 0 : depth_.size(), 0);
}

void Solver::count_passing(bool second) {
    for (std::size_t k = 0; k < faces_.size(); ++k) {
        const Face& face = faces_[k];
        float& passes = (face.north ? passes_north_ : passes_east_)[index(face.column, face.row)];
        // Heun's method takes the mean of what passes in either stage.
        passed_[k] = (second ? passed_[k] : 0) + 0.5 * static_cast<double>(passes) * time_step_ * geometry_.cell;
        passes = 0;  // cells that take no part in a step write nothing
    }
}

}  // namespace talus::depth
