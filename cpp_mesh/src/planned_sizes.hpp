// The sizes that the cells of a new mesh are to have, and how many cells these are.
#ifndef CPP_MESH_PLANNED_SIZES_HPP
#define CPP_MESH_PLANNED_SIZES_HPP

#include "mesh.hpp"

#include <memory>
#include <vector>

namespace cpp_mesh {

// As wanted at the nodes of another mesh, or growing from the fractures; both with the rosettes,
// joints and narrow places of the graph.
SizeField planned_sizes(const Specification& specification, const Graph& graph,
                        const std::vector<RosettePlan>& plans,
                        std::shared_ptr<const NodalSizes> wanted);

// Expected numbers of cells; they may exceed the range of integers.
struct ExpectedCells {
    double cells = 0.0;
    double fracture_cells = 0.0;
};

// The integral of these sizes over the body and along the fractures.
ExpectedCells expected_cells(const Specification& specification, const Graph& graph,
                             const std::vector<RosettePlan>& plans);

} // namespace cpp_mesh

#endif
