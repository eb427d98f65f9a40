// gmsh is stopped where it does far more than the sizes ask for, and goes on with the next region.
#include "checks.hpp"
#include "errors.hpp"
#include "gmsh_session.hpp"

using namespace cpp_mesh;

namespace {

// The unit square with cells of a tenth.
struct Square {
    Region region;
    std::vector<Vec2> xy;
    SizeField size;

    Square() {
        std::vector<int> loop;
        const std::vector<Vec2> corners = {{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}};
        for (int side = 0; side < 4; ++side)
            for (int k = 0; k < 10; ++k) {
                loop.push_back(static_cast<int>(xy.size()));
                xy.push_back(along(corners[side], corners[(side + 1) % 4], 0.1 * k));
            }
        region.loops.push_back(loop);
        size =
            SizeField({{{0.0, 0.0}, {1.0, 0.0}, 0.1}}, Domain(Rectangle{0.0, 1.0, 0.0, 1.0}), 0.1);
    }
};

std::string refusal(double coverage) {
    Square square;
    try {
        GmshSession::shared()->triangulate(square.region, square.size, square.xy, coverage);
    } catch (const MeshError& error) {
        return error.what();
    }
    return "";
}

// Questions with this size until it is too much.
long allowed(double size, double coverage) {
    WorkLimit limit(2.0, coverage);
    long n = 0;
    while (limit.allows(size))
        ++n;
    return n;
}

} // namespace

int main() {
    Checks checks;
    checks.is_close(static_cast<double>(allowed(0.01, 3.0)), 3.0 * 2.0 / 1e-4, 1.5, "by area");
    checks.is_close(static_cast<double>(allowed(1e-9, 1e-4)), 1e4, 1.5, "tiny sizes end too");
    checks.is_close(static_cast<double>(allowed(10.0, 3.0)), 3000.0, 1.5, "large sizes have time");

    Square first;
    const std::size_t n =
        GmshSession::shared()->triangulate(first.region, first.size, first.xy).size();
    checks.is_true(n > 200 && n < 300, "a square: " + std::to_string(n));

    checks.says(refusal(0.1), "gmsh was stopped", "a tenth of the square");
    checks.says(refusal(0.01), "gmsh was stopped", "at the given nodes");
    Square again;
    const std::vector<Triangle> cells =
        GmshSession::shared()->triangulate(again.region, again.size, again.xy);
    checks.is_true(cells.size() == n && again.xy == first.xy, "the same mesh as before the stop");
    return checks.finish();
}
