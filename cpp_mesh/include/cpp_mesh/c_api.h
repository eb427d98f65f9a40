// The border between Fortran and the C++ mesh library. The header is the contract.
//
// Every function returns 0 for success, else cm_last_error() says why. No exception crosses.
// Handles are opaque and C++ owns what is behind them; every array belongs to the caller, who asks
// for sizes first. Indices count from 0; -1 means "none". Lengths are in metres. Orientation of
// fractures: side + on the right of the polyline's direction, side - on the left
// (fortran/mesh/mesh_types.f90 says the same).
#ifndef CPP_MESH_C_API_H
#define CPP_MESH_C_API_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct cm_mesh cm_mesh;

/* Fracture polylines: vertices of fracture f are first[f] .. first[f+1]-1. */
typedef struct {
    int32_t n_fractures;
    const int32_t* first;  /* [n_fractures + 1] */
    const double* xy;      /* [n_vertices][2] */
    const double* s_start; /* [n_fractures] arc length of the first vertex */
} cm_network;

/* What to mesh: a rectangle or a polygon, cut by the fractures. Cell sizes grow linearly from
   size_fracture at the fractures to size_boundary, reached at half the distance to the point of the
   body farthest from them, so that most of the boundary has it. With is_window the body is a
   rectangle and fractures may be cut by its edges (those ends become boundary points); without it a
   fracture that leaves the body is refused. With rosette_sectors, every free tip gets a rosette of
   so many triangles with radius `rosette_radius` (made smaller where another fracture, tip, kink,
   fixed point or edge is near); an end on the boundary is no free tip.

   A polygon may have re-entrant corners. Its edges are divided as the sizes ask; one shorter than
   that stays whole, and the cells grow from its length inwards: a disc is a polygon of many edges
   with the same side number. */
typedef struct {
    double x_min, x_max, y_min, y_max;
    double size_fracture, size_boundary;
    int32_t is_window;
    int32_t rosette_sectors; /* 0: no rosettes */
    double rosette_radius;
    int32_t n_corners;        /* 0: the rectangle, whose sides are 1 left 2 right 3 bottom 4 top */
    const double* corners;    /* [n_corners][2] counter-clockwise; x_min .. y_max are not used */
    const int32_t* edge_side; /* [n_corners] 1 or more, of the edge from each corner to the next */
    int32_t n_fixed;          /* places that become nodes: on the boundary, inside, on fractures */
    const double* fixed;      /* [n_fixed][2] */
    const double* end_radius; /* [n_fractures][2] rosette radius at start and end; 0: the usual one;
                                 NULL: all have the usual one */
    int32_t n_guides; /* lines that cells follow where there is room; the mesh is not cut there */
    const int32_t* guide_count; /* [n_guides] points of each, 2 or more */
    const double* guide_xy;     /* [sum of the counts][2] */
    double joint_size; /* cells at the places where fractures meet; 0: as along fractures */
    int32_t n_foci; /* places away from which cells grow along the fractures, too; 0: they do not */
    const double* foci; /* [n_foci][2] */
    double focus_slope; /* growth of sizes per distance from the nearest of them */
    double focus_size;  /* largest size along fractures that this leads to */
    int32_t is_rough;   /* gmsh's faster triangles, which are smoothed here only: half the time */
    double ring_slope;  /* growth of sizes per distance beyond three radii of rosettes; 0: as
                           nearer to them, 0.3 */
    const double* own_size; /* [n_fractures] size along each fracture, no larger than size_boundary,
                               or with foci the largest one that these lead to; 0: size_fracture
                               and focus_size; NULL: so have all. Tolerances follow from
                               size_fracture, which is then the smallest of all */
    int32_t n_refined;      /* places with smaller cells, which grow from there */
    const double* refined;  /* [n_refined][4] x, y, size, radius within which cells have it */
} cm_spec;

typedef struct {
    int32_t n_nodes, n_cells, n_faces;
    int32_t n_fracture_cells, n_fracture_points, n_point_cells, n_tips;
} cm_counts;

/* Arrays to fill; shapes follow cm_counts. */
typedef struct {
    double* xy;                  /* [n_nodes][2] */
    int32_t* cell_nodes;         /* [n_cells][3] counter-clockwise */
    int32_t* cell_faces;         /* [n_cells][3] face k joins nodes k and (k+1)%3 */
    int32_t* face_nodes;         /* [n_faces][2] */
    int32_t* face_cells;         /* [n_faces][2] */
    int32_t* face_side;          /* [n_faces] side of the outer boundary, 0 elsewhere */
    int32_t* face_fracture_cell; /* [n_faces] */
    int32_t* fcell_fracture;     /* [n_fracture_cells] */
    int32_t* fcell_points;       /* [n_fracture_cells][2] */
    int32_t* fcell_faces;        /* [n_fracture_cells][2] side +, side - */
    double* fcell_s;             /* [n_fracture_cells][2] */
    double* point_xy;            /* [n_fracture_points][2] */
    int32_t* point_kind;         /* [n_fracture_points] 0 interior 1 tip 2 boundary 3 T 4 X 5 V */
    int32_t* point_first;        /* [n_fracture_points + 1] */
    int32_t* point_cells;        /* [n_point_cells] */
    int32_t* tip_point;          /* [n_tips] */
    int32_t* tip_node;           /* [n_tips] */
    int32_t* tip_fracture;       /* [n_tips] */
    int32_t* tip_end;            /* [n_tips] 1 start, 2 end */
    double* tip_direction;       /* [n_tips][2] */
    double* tip_radius;          /* [n_tips] */
} cm_arrays;

const char* cm_last_error(void);

/* Why the last call of this thread failed. */
typedef enum {
    cm_fault_none = 0,
    cm_fault_other = 1,     /* not the geometry: sizes, memory, gmsh, a wrong call */
    cm_fault_number = 2,    /* a coordinate is no number, or there are too few of them */
    cm_fault_body = 3,      /* the boundary encloses no body or meets itself */
    cm_fault_outside = 4,   /* lies outside the body or leaves it */
    cm_fault_boundary = 5,  /* a fracture meets the boundary otherwise than with an end */
    cm_fault_too_short = 6, /* a segment of a fracture */
    cm_fault_too_near = 7,  /* things nearly meet, but do not */
    cm_fault_angle = 8,     /* too small for cells of fair shape */
    cm_fault_overlap = 9    /* fractures, or one and a fixed point, lie on each other */
} cm_fault_kind;

typedef enum {
    cm_culprit_fracture = 1,
    cm_culprit_corner = 2, /* of the boundary; those of a rectangle from the lower left */
    cm_culprit_edge = 3,   /* from the corner of the same number */
    cm_culprit_fixed = 4   /* a fixed point of the specification */
} cm_culprit_kind;

typedef struct {
    int32_t kind;            /* cm_fault_kind */
    int32_t n_culprits;      /* 0 to 2 */
    int32_t culprit_kind[2]; /* cm_culprit_kind */
    int32_t culprit[2];      /* which one, in the order of the input */
    int32_t has_place;
    double x, y;        /* where [m] */
    const char* reason; /* a sentence in which {1} and {2} stand for the culprits; stays until the
                           next call of this thread */
} cm_fault;

void cm_last_fault(cm_fault* fault);

/* A place inside the body where two fractures meet, or parts of one (then twice the same). */
typedef struct {
    int32_t fracture[2];
    double x, y;
} cm_joint;

/* Judge what cm_create would mesh, by the same code, but mesh nothing; fails where the body or the
   network is at fault, and where a fixed point would have a node on each face of a fracture. Up to
   `capacity` joints are listed, of all there are. Expected numbers of cells and of fracture cells
   by the sizes that the mesh would get, unless `n_cells` is NULL. */
int cm_check(const cm_spec* spec, const cm_network* network, int32_t capacity,
             cm_joint* joints /* [capacity] */, int32_t* n_joints, double* n_cells /* [2] */);

int cm_create(const cm_spec* spec, const cm_network* network, cm_mesh** mesh);

/* A new mesh of the same body whose cells have about the sizes (lengths of edges) that are wanted
   in the cells of an old mesh, where they lie; sizes grow from cell to cell by a factor of at most
   about 1.3 and stay below size_boundary; size_fracture gives tolerances only. Fractures may have
   grown; their cells follow the sizes too. Rosettes are made as the specification says. */
int cm_create_sized(const cm_spec* spec, const cm_network* network, const cm_mesh* old_mesh,
                    int32_t n_sizes, const double* cell_size /* [n_sizes] */, cm_mesh** mesh);

/* A new mesh that differs from `old_mesh` only within `radius` of the given centres; `network` is
   the old one with vertices added at the ends of fractures. Existing fracture cells stay as they
   are, but where a new segment ends on one: it is divided, or the node between it and its
   neighbour moves there, and both are new then. Each new segment becomes one or more fracture cells
   of about `size`, or of the size that the fracture has of its own. Nodes and cells outside are
   untouched. The patch is enlarged where it must hold new segments or cells twice too large next to
   them. A mesh with rosettes is refused: make a new one. */
int cm_remesh(const cm_mesh* old_mesh, const cm_network* network, int32_t n_centres,
              const double* centres /* [n_centres][2] */, double radius, double size,
              cm_mesh** new_mesh);

/* A mesh of a grown network for a body with rosettes, a polygon or fixed points, that differs from
   `old_mesh` only in patches around the ends that have grown: `network` is the old one with
   vertices added there. Sizes, and rosettes at the ends that have grown, are those of a new mesh
   (end_radius as in cm_spec); rosettes of other tips stay, unless their radius changes or the patch
   reaches them. Fracture cells in the patches are divided again, those outside stay. Fails where
   the patch would hold most of the body, cells would get angles below 22 degrees and below those of
   the cells that they replace, or anything does not fit: make a new mesh then. */
int cm_grow(const cm_mesh* old_mesh, const cm_network* network,
            const double* end_radius /* [n_fractures][2], or NULL */, cm_mesh** new_mesh);

/* The cells of `old_mesh`, whose nodes have moved along with its tips: `network` is the old one in
   which ends of fractures lie elsewhere. The piece from the vertex before each of them is scaled
   and turned, the cells around the tip with it, and so is the rosette; fractures and the boundary
   stay, and what lies between follows as far as `reach` times the length of the piece in `old_mesh`
   from it. Fails where the network differs otherwise, a piece would
   become more than three times longer or shorter or turn by more than 17 degrees, or cells would
   get angles below 17 degrees and below those that they have: make a new mesh then. Guides and
   fixed points inside the body are not followed. */
int cm_move_tips(const cm_mesh* old_mesh, const cm_network* network, double reach,
                 cm_mesh** new_mesh);

int cm_sizes(const cm_mesh* mesh, cm_counts* counts);
int cm_copy(const cm_mesh* mesh, const cm_arrays* arrays);

/* How a mesh made by cm_remesh covers the one it was made from (see mesh_map_t). */
int cm_map_sizes(const cm_mesh* new_mesh, int32_t* n_overlaps);
int cm_map_copy(const cm_mesh* new_mesh, int32_t* cell_old /* [n_cells] */,
                int32_t* overlap_first /* [n_cells + 1] */, int32_t* overlap_cell,
                double* overlap_area, int32_t* fcell_old /* [n_fracture_cells] */);

/* The smallest angle of all cells [rad], and the cell that has it. */
int cm_quality(const cm_mesh* mesh, double* smallest_angle, int32_t* worst_cell);

/* The cell that holds each point, -1 outside the body. */
int cm_locate(const cm_mesh* mesh, int32_t n_points, const double* xy /* [n_points][2] */,
              int32_t* cells);

/* The bytes of a mesh for a checkpoint, and the same mesh from them, in the same program. Those of
   a mesh are written if the buffer is large enough; `n_bytes` says how many there are. */
int cm_store(const cm_mesh* mesh, int64_t capacity, char* bytes /* [capacity] */, int64_t* n_bytes);
int cm_load(int64_t n_bytes, const char* bytes /* [n_bytes] */, cm_mesh** mesh);

void cm_destroy(cm_mesh** mesh); /* sets NULL */

#ifdef __cplusplus
}
#endif

#endif
