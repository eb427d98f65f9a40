// Which old cells are made again.
#ifndef CPP_MESH_PATCH_CHOICE_HPP
#define CPP_MESH_PATCH_CHOICE_HPP

#include "patch.hpp"
#include "patch_task.hpp"

#include <array>
#include <vector>

namespace cpp_mesh {

struct PatchRequest {
    std::vector<char> marked; // old cells that go in any case
    std::vector<std::array<Vec2, 2>> new_segments;
    // Cells go that are nearer to new segments, and to rosettes that come or go, than so many cells
    // of the size wanted there: room for cells of good shape.
    double margin_in_cells = 0.0;
    // Cells go that are longer than this times these sizes: they would leave no room to grow
    // smoothly.
    double largest_ratio = 0.0;
    SizeField size;
    // Cells of unfit size apart from the growth that hang together in smaller numbers are left.
    int smallest_part = 0;
};

// The cells of the request, those of unfit size around them, and what makes the patch simple. A
// rosette stays where no cell of it goes and its radius is still wanted; the task's plans of such
// rosettes are taken out.
Patch choose_patch(const PatchRequest& request, PatchTask& task);

} // namespace cpp_mesh

#endif
