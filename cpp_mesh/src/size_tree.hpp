// A tree of places that make cells small, which passes over those that are too far away to matter.
#ifndef CPP_MESH_SIZE_TREE_HPP
#define CPP_MESH_SIZE_TREE_HPP

#include "geometry.hpp"

#include <utility>
#include <vector>

namespace cpp_mesh {

class SizeTree {
public:
    // Sizes at a distance d from the box are at least size + slope max(0, d - radius).
    struct Bound {
        Vec2 low, high;
        double size = 0.0, slope = 0.0, radius = 0.0;

        double at(Vec2 p) const {
            const Vec2 gap = {std::max({low.x - p.x, 0.0, p.x - high.x}),
                              std::max({low.y - p.y, 0.0, p.y - high.y})};
            return size + slope * std::max(0.0, length(gap) - radius);
        }
    };

    SizeTree() = default;
    explicit SizeTree(const std::vector<Bound>& items);

    int size() const { return static_cast<int>(order_.size()); }

    // The action on every item that may lower the size at p, which the action does.
    template <typename Action> void lower(Vec2 p, const double& size, Action&& action) const {
        if (!branches_.empty())
            visit(0, branches_[0].bound.at(p), p, size, action);
    }

private:
    // Items first .. last-1; a branch is followed by its left half, `right` is the other.
    struct Branch {
        Bound bound;
        int first = 0, last = 0;
        int right = -1; // -1: a leaf
    };

    static constexpr double rounding = 1e-9; // of sizes that are compared

    void grow(const std::vector<Bound>& items, int first, int last);

    template <typename Action>
    void visit(int number, double least, Vec2 p, const double& size, Action&& action) const {
        if (least > (1.0 + rounding) * size)
            return;
        const Branch& branch = branches_[number];
        if (branch.right < 0) {
            for (int k = branch.first; k < branch.last; ++k)
                action(order_[k]);
            return;
        }
        std::pair<double, int> near = {branches_[number + 1].bound.at(p), number + 1};
        std::pair<double, int> far = {branches_[branch.right].bound.at(p), branch.right};
        if (far < near)
            std::swap(near, far);
        visit(near.second, near.first, p, size, action);
        visit(far.second, far.first, p, size, action);
    }

    std::vector<int> order_;
    std::vector<Branch> branches_;
};

} // namespace cpp_mesh

#endif
