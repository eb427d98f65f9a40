// Which cell holds a point?
#ifndef CPP_MESH_LOCATE_HPP
#define CPP_MESH_LOCATE_HPP

#include "plane_mesh.hpp"

#include <vector>

namespace cpp_mesh {

// A tree of boxes around cells: cells may differ in size by orders of magnitude.
class CellTree {
public:
    // Only the given cells of the mesh, which must stay where it is.
    CellTree(const std::vector<Vec2>& xy, const std::vector<Triangle>& cells,
             std::vector<int> members);
    CellTree(const std::vector<Vec2>& xy, const std::vector<Triangle>& cells); // all cells

    // The cell that holds p, or -1. On an edge it is one of the cells that share it. The guess, a
    // cell of the mesh or -1, changes how long it takes.
    int locate(Vec2 p, int guess = -1) const;

    // Cells whose boxes touch the given one, each once, in ascending order.
    void candidates(Vec2 low, Vec2 high, std::vector<int>& found) const;

private:
    struct Box {
        Vec2 low, high;

        bool touches(Vec2 other_low, Vec2 other_high) const {
            return low.x <= other_high.x && high.x >= other_low.x && low.y <= other_high.y &&
                   high.y >= other_low.y;
        }
    };

    // Members first .. last-1; a branch is followed by its left half, `right` is the other.
    struct Branch {
        Box box;
        int first = 0, last = 0;
        int right = -1; // -1: a leaf
    };

    void grow(int first, int last);
    Box box_of(int cell) const;
    double depth_in(int cell, Vec2 p) const;
    // The action on every member of every leaf whose box touches the given one.
    template <typename Action> void visit(Vec2 low, Vec2 high, Action&& action) const;

    const std::vector<Vec2>& xy_;
    const std::vector<Triangle>& cells_;
    std::vector<int> members_;
    std::vector<Branch> branches_;
};

} // namespace cpp_mesh

#endif
