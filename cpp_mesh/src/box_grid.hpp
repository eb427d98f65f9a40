// Boxes in the plane, found by place.
#ifndef CPP_MESH_BOX_GRID_HPP
#define CPP_MESH_BOX_GRID_HPP

#include "geometry.hpp"

#include <vector>

namespace cpp_mesh {

// A grid of squares that hold the numbers of the boxes over them. Boxes may be added at any time,
// and may lie outside the extent, where they belong to its outermost squares.
class BoxGrid {
public:
    // About as many squares as boxes are expected.
    BoxGrid(const Rectangle& extent, std::size_t expected)
        : origin_({extent.x_min, extent.y_min}),
          per_side_(static_cast<int>(
              std::clamp(std::sqrt(static_cast<double>(expected)), 1.0, most_per_side))),
          width_(std::max(extent.width(), extent.height()) / per_side_),
          squares_(static_cast<std::size_t>(per_side_) * per_side_) {}

    void add(int number, Vec2 low, Vec2 high) {
        visit(low, high, [&](std::vector<int>& square) { square.push_back(number); });
    }

    // The numbers of all boxes that touch the given one and of some others, ascending, each once.
    const std::vector<int>& candidates(Vec2 low, Vec2 high) {
        found_.clear();
        visit(low, high, [&](const std::vector<int>& square) {
            found_.insert(found_.end(), square.begin(), square.end());
        });
        std::sort(found_.begin(), found_.end());
        found_.erase(std::unique(found_.begin(), found_.end()), found_.end());
        return found_;
    }

private:
    static constexpr double most_per_side = 1024.0;

    int place(double distance) const {
        return static_cast<int>(std::clamp(distance / width_, 0.0, per_side_ - 1.0));
    }

    template <typename Action> void visit(Vec2 low, Vec2 high, Action&& action) {
        const int last_x = place(high.x - origin_.x), last_y = place(high.y - origin_.y);
        for (int x = place(low.x - origin_.x); x <= last_x; ++x)
            for (int y = place(low.y - origin_.y); y <= last_y; ++y)
                action(squares_[static_cast<std::size_t>(x) * per_side_ + y]);
    }

    Vec2 origin_;
    int per_side_;
    double width_;
    std::vector<std::vector<int>> squares_;
    std::vector<int> found_;
};

} // namespace cpp_mesh

#endif
