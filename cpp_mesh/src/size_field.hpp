// How large cells should be, as a function of place.
#ifndef CPP_MESH_SIZE_FIELD_HPP
#define CPP_MESH_SIZE_FIELD_HPP

#include "domain.hpp"
#include "geometry.hpp"
#include "nodal_sizes.hpp"
#include "size_tree.hpp"

#include <memory>
#include <vector>

namespace cpp_mesh {

// Cells have `size` on the segment and grow linearly away from it; where foci let them grow along
// it, up to `largest`, if that is not 0.
struct SizeSource {
    Vec2 a, b;
    double size = 0.0;
    double largest = 0.0;
};

// Cells have `size` within `radius` of the centre and grow away from it by `slope` per distance,
// beyond three radii by `far_more` more than that.
struct SizeDisc {
    Vec2 centre;
    double radius = 0.0;
    double size = 0.0;
    double slope = 0.3;
    double far_more = 0.0;

    double operator()(Vec2 p) const;
};

// Cells that sources make as small as `size` may grow by `slope` per distance from the nearest
// place, up to `largest`. Without places they may not.
struct SizeFoci {
    std::vector<Vec2> places;
    double size = 0.0, slope = 0.0, largest = 0.0;

    double operator()(Vec2 p) const { return up_to(largest, p); }
    double up_to(double most, Vec2 p) const;
    // Of a corner of fractures: `smallest` near a place, and as many times larger as it is farther
    // away than `size`.
    double at_corner(double smallest, Vec2 p) const;

private:
    double from_nearest(Vec2 p) const;
};

class SizeField {
public:
    SizeField() = default;
    // Grows from the sources to size_far at half the distance to the body's farthest point.
    SizeField(std::vector<SizeSource> sources, const Domain& domain, double size_far);

    // As wanted at the nodes of another mesh, and grown from sources that are added.
    explicit SizeField(std::shared_ptr<const NodalSizes> wanted)
        : wanted_(std::move(wanted)), slope_(NodalSizes::growth) {}

    double operator()(Vec2 p) const;
    bool follows_other_mesh() const { return wanted_ != nullptr; }
    void add(const SizeSource& source) { sources_.push_back(source); }
    void add(const SizeDisc& disc) { discs_.push_back(disc); }
    void set_foci(SizeFoci foci) { foci_ = std::move(foci); }
    // Sort what there is by place, which changes nothing but the time that a size takes.
    void arrange();
    // Decisions must not depend on rounding errors: the same body in another unit of length is to
    // get the same mesh.
    void make_scale_free() { is_scale_free_ = true; }
    bool is_scale_free() const { return is_scale_free_; }
    void set_discs(std::vector<SizeDisc> discs) {
        discs_ = std::move(discs);
        disc_tree_ = {};
    }

    // Every member in turn, to store or load it.
    template <typename Archive> void visit(Archive& archive) {
        archive(sources_, discs_, foci_, wanted_, slope_, largest_, is_scale_free_);
    }

    // What this field has and another one lacks; without limit elsewhere.
    SizeField less(const SizeField& other) const;

private:
    std::vector<SizeSource> sources_;
    std::vector<SizeDisc> discs_;
    SizeTree source_tree_, disc_tree_; // of the first ones
    SizeFoci foci_;
    std::shared_ptr<const NodalSizes> wanted_;
    double slope_ = 0.0;
    double largest_ = 0.0;
    bool is_scale_free_ = false;
};

// Parameters 0 = t0 < ... < tn = 1 that divide the segment a-b into cells of the wanted size.
std::vector<double> divide_segment(Vec2 a, Vec2 b, const SizeField& size);

} // namespace cpp_mesh

#endif
