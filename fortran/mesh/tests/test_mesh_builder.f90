!> Meshes through the Fortran interface: indices from 1, shapes, maps, ownership. The meshes
!! themselves are tested in C++ (cpp_mesh/tests).
program test_mesh_builder
   use base_errors, only: error_t
   use base_kinds, only: ik, pi, rk
   use base_texts, only: text_t
   use mesh_builder, only: build_mesh, locate, mesh_spec_t, mesher_t, remesh, transfer_mesher
   use mesh_types, only: mesh_map_t, mesh_t, network_t, point_boundary, point_interior, &
                         point_joint_t, point_joint_x, point_tip, side_count
   use testing_checks, only: checks_t
   implicit none(type, external)

   type(checks_t) :: checks
   type(error_t), allocatable :: error
   type(mesher_t) :: mesher

   call test_without_fracture(checks)
   call test_single_fracture(checks)
   call test_directions(checks)
   call test_crossing(checks)
   call test_window(checks)
   call test_refusals(checks)
   call test_locate(checks)
   call test_remesh(checks)
   call test_ownership(checks)
   call checks%finish()

contains

   !> One polyline per column pair: `ends(:, :, f)` are the two ends of fracture f.
   function straight_network(ends) result(network)
      real(rk), intent(in) :: ends(:, :, :)
      type(network_t) :: network
      integer :: f, n

      n = ubound(ends, 3)
      allocate (network%first, source=[(1_ik + 2_ik*f, f=0, n)])
      allocate (network%xy, source=reshape(ends, [2, 2*n]))
      allocate (network%s_start(n), source=0.0_rk)
   end function straight_network

   !> Signed areas of all cells.
   function cell_areas(mesh) result(areas)
      type(mesh_t), intent(in) :: mesh
      real(rk), allocatable :: areas(:)
      real(rk) :: a(2), b(2), c(2)
      integer :: i

      allocate (areas(mesh%n_cells))
      do i = 1, mesh%n_cells
         a = mesh%xy(:, mesh%cell_nodes(1, i))
         b = mesh%xy(:, mesh%cell_nodes(2, i))
         c = mesh%xy(:, mesh%cell_nodes(3, i))
         areas(i) = 0.5_rk*((b(1) - a(1))*(c(2) - a(2)) - (b(2) - a(2))*(c(1) - a(1)))
      end do
   end function cell_areas

   !> What holds for every mesh: area, Euler characteristic, faces that agree with cells, sides.
   subroutine check_mesh(checks, mesh, area, euler, name)
      type(checks_t), intent(inout) :: checks
      type(mesh_t), intent(in) :: mesh
      real(rk), intent(in) :: area
      integer, intent(in) :: euler
      character(len=*), intent(in) :: name
      real(rk), allocatable :: areas(:)

      allocate (areas, source=cell_areas(mesh))
      call checks%is_true(all(areas > 0.0_rk), name//": areas are positive")
      call checks%is_close(sum(areas), area, 1.0e-12_rk*area, name//": area")
      call checks%is_true(mesh%n_nodes - mesh%n_faces + mesh%n_cells == euler, &
                          name//": Euler characteristic")
      call checks%is_true(wrong_faces(mesh) == 0, name//": faces and cells agree")
      call checks%is_true(wrong_sides(mesh) == 0, name//": sides of fracture cells")
   end subroutine check_mesh

   !> Face k of a cell joins its nodes k and mod(k,3)+1, and is a face of that cell.
   integer function wrong_faces(mesh)
      type(mesh_t), intent(in) :: mesh
      integer :: i, k, face, a, b

      wrong_faces = 0
      do i = 1, mesh%n_cells
         do k = 1, 3
            face = mesh%cell_faces(k, i)
            a = mesh%cell_nodes(k, i)
            b = mesh%cell_nodes(mod(k, 3) + 1, i)
            if (.not. any(mesh%face_cells(:, face) == i)) wrong_faces = wrong_faces + 1
            if (.not. all([minval(mesh%face_nodes(:, face)), maxval(mesh%face_nodes(:, face))] &
                          == [min(a, b), max(a, b)])) wrong_faces = wrong_faces + 1
         end do
      end do
      do face = 1, mesh%n_faces
         if (mesh%face_cells(1, face) < 1) wrong_faces = wrong_faces + 1
         if ((mesh%face_cells(2, face) == 0) .neqv. &
             (mesh%face_side(face) > 0 .or. mesh%face_fracture_cell(face) > 0)) then
            wrong_faces = wrong_faces + 1
         end if
      end do
   end function wrong_faces

   !> Side + lies to the right of the fracture, side - to the left.
   integer function wrong_sides(mesh)
      type(mesh_t), intent(in) :: mesh
      real(rk) :: a(2), b(2), centre(2), left
      integer :: i, side, face

      wrong_sides = 0
      do i = 1, mesh%fracture%n_cells
         a = mesh%fracture%point_xy(:, mesh%fracture%cell_points(1, i))
         b = mesh%fracture%point_xy(:, mesh%fracture%cell_points(2, i))
         do side = 1, 2
            face = mesh%fracture%cell_faces(side, i)
            if (mesh%face_fracture_cell(face) /= i) wrong_sides = wrong_sides + 1
            centre = sum(mesh%xy(:, mesh%cell_nodes(:, mesh%face_cells(1, face))), 2)/3.0_rk
            left = (b(1) - a(1))*(centre(2) - a(2)) - (b(2) - a(2))*(centre(1) - a(1))
            if ((left > 0.0_rk) .neqv. (side == 2)) wrong_sides = wrong_sides + 1
         end do
      end do
   end function wrong_sides

   !> Nodes at a place.
   integer function copies(mesh, xy)
      type(mesh_t), intent(in) :: mesh
      real(rk), intent(in) :: xy(2)

      copies = count(hypot(mesh%xy(1, :) - xy(1), mesh%xy(2, :) - xy(2)) < 1.0e-9_rk)
   end function copies

   !> Kind of the fracture point at a place; -1 if there is none.
   integer function kind_at(mesh, xy)
      type(mesh_t), intent(in) :: mesh
      real(rk), intent(in) :: xy(2)
      integer :: p

      kind_at = -1
      do p = 1, mesh%fracture%n_points
         associate (at => mesh%fracture%point_xy(:, p))
            if (hypot(at(1) - xy(1), at(2) - xy(2)) < 1.0e-9_rk) then
               kind_at = mesh%fracture%point_kind(p)
            end if
         end associate
      end do
   end function kind_at

   !> A network without arrays is no network.
   subroutine test_without_fracture(checks)
      type(checks_t), intent(inout) :: checks
      type(mesh_t) :: mesh
      type(network_t) :: network
      real(rk) :: length
      integer :: side, face

      call build_mesh(mesh_spec_t(0.0_rk, 2.0_rk, 1.0_rk, 2.0_rk, 0.2_rk, 0.2_rk), network, &
                      mesher, mesh, error)
      call checks%no_error(error, "no fracture")
      call check_mesh(checks, mesh, 2.0_rk, 1, "no fracture")
      call checks%is_true(mesh%fracture%n_cells == 0 .and. mesh%fracture%n_points == 0 .and. &
                          mesh%fracture%n_tips == 0, "no fracture: nothing of fractures")
      do side = 1, side_count
         length = 0.0_rk
         do face = 1, mesh%n_faces
            if (mesh%face_side(face) /= side) cycle
            length = length + norm2(mesh%xy(:, mesh%face_nodes(2, face)) - &
                                    mesh%xy(:, mesh%face_nodes(1, face)))
         end do
         call checks%is_close(length, merge(1.0_rk, 2.0_rk, side <= 2), 1.0e-12_rk, &
                              "no fracture: length of the sides")
      end do
   end subroutine test_without_fracture

   !> Scene C1.
   subroutine test_single_fracture(checks)
      type(checks_t), intent(inout) :: checks
      type(mesh_t) :: mesh, again
      type(network_t) :: network
      real(rk) :: d
      integer :: i, t

      d = 0.05_rk*sqrt(0.5_rk)
      network = straight_network(reshape([1.0_rk - d, 1.0_rk - d, 1.0_rk + d, 1.0_rk + d], &
                                         [2, 2, 1]))
      network%s_start = [3.0_rk]
      call build_mesh(mesh_spec_t(0.0_rk, 2.0_rk, 0.0_rk, 2.0_rk, 0.01_rk, 0.1_rk), network, &
                      mesher, mesh, error)
      call checks%no_error(error, "single")
      call check_mesh(checks, mesh, 4.0_rk, 0, "single")
      associate (f => mesh%fracture)
         call checks%is_true(f%n_cells == 10 .and. f%n_points == 11 .and. f%n_tips == 2, &
                             "single: numbers of cells, points, tips")
         call checks%is_true(all(f%cell_fracture == 1), "single: fractures count from 1")
         do i = 1, f%n_cells
            call checks%is_close(f%cell_s(1, i), 3.0_rk + 0.01_rk*(i - 1), 1.0e-14_rk, &
                                 "single: arc length of starts")
            call checks%is_close(f%cell_s(2, i), 3.0_rk + 0.01_rk*i, 1.0e-14_rk, &
                                 "single: arc length of ends")
         end do
         call checks%is_true(count(f%point_kind == point_tip) == 2 .and. &
                             count(f%point_kind == point_interior) == 9, "single: kinds of points")
         call checks%is_true(f%point_cells%length(1_ik) == 1 .and. size(f%point_cells%item) == 20, &
                             "single: cells of points")
         do t = 1, 2
            call checks%is_true(f%tip_fracture(t) == 1 .and. f%tip_end(t) == t, "single: tips")
            call checks%is_close(norm2(mesh%xy(:, f%tip_node(t)) - f%point_xy(:, f%tip_point(t))), &
                                 0.0_rk, 0.0_rk, "single: tip node and tip point")
            call checks%is_true(copies(mesh, mesh%xy(:, f%tip_node(t))) == 1, "single: one node")
            call checks%is_close(norm2(f%tip_direction(:, t) - &
                                       sqrt(0.5_rk)*real(2*t - 3, rk)), 0.0_rk, 1.0e-12_rk, &
                                 "single: direction ahead of the tip")
         end do
      end associate
      call build_mesh(mesh_spec_t(0.0_rk, 2.0_rk, 0.0_rk, 2.0_rk, 0.01_rk, 0.1_rk), network, &
                      mesher, again, error)
      call checks%is_true(all(shape(again%xy) == shape(mesh%xy)), "single: the same size again")
      call checks%is_true(all(abs(again%xy - mesh%xy) <= 0.0_rk), "single: the same again, bitwise")
      call checks%is_true(all(again%cell_nodes == mesh%cell_nodes), "single: the same cells again")
   end subroutine test_single_fracture

   !> Sides and tips in all directions.
   subroutine test_directions(checks)
      type(checks_t), intent(inout) :: checks
      type(mesh_t) :: mesh
      real(rk) :: angle, ahead(2)
      integer :: k

      do k = 0, 11
         angle = k*pi/6.0_rk
         ahead = [cos(angle), sin(angle)]
         call build_mesh(mesh_spec_t(-1.0_rk, 1.0_rk, -1.0_rk, 1.0_rk, 0.1_rk, 0.3_rk), &
                         straight_network(reshape([-0.3_rk*ahead, 0.3_rk*ahead], [2, 2, 1])), &
                         mesher, mesh, error)
         call checks%no_error(error, "directions")
         call check_mesh(checks, mesh, 4.0_rk, 0, "directions")
         call checks%is_close(norm2(mesh%fracture%tip_direction(:, 2) - ahead), 0.0_rk, &
                              1.0e-12_rk, "directions: ahead of the end")
         call checks%is_close(norm2(mesh%fracture%tip_direction(:, 1) + ahead), 0.0_rk, &
                              1.0e-12_rk, "directions: ahead of the start")
      end do
   end subroutine test_directions

   !> An X, a T and an end on the boundary in one network (AB and CD of Paper D with two more).
   subroutine test_crossing(checks)
      type(checks_t), intent(inout) :: checks
      type(mesh_t) :: mesh
      type(network_t) :: network
      real(rk), parameter :: place_x(2) = [1.0_rk, 1.0_rk]

      network = straight_network(reshape([1.0_rk, 1.15_rk, 1.0_rk, 0.85_rk, &
                                          0.85_rk, 0.97_rk, 1.15_rk, 1.03_rk, &
                                          1.0_rk, 1.1_rk, 1.3_rk, 1.2_rk, &
                                          2.0_rk, 0.4_rk, 1.6_rk, 0.5_rk], [2, 2, 4]))
      call build_mesh(mesh_spec_t(0.0_rk, 2.0_rk, 0.0_rk, 2.0_rk, 0.02_rk, 0.1_rk), network, &
                      mesher, mesh, error)
      call checks%no_error(error, "joints")
      call check_mesh(checks, mesh, 4.0_rk, 0, "joints")
      call checks%is_true(kind_at(mesh, place_x) == point_joint_x, "joints: X")
      call checks%is_true(copies(mesh, place_x) == 4, "joints: four nodes at the X")
      call checks%is_true(kind_at(mesh, [1.0_rk, 1.1_rk]) == point_joint_t, "joints: T")
      call checks%is_true(copies(mesh, [1.0_rk, 1.1_rk]) == 3, "joints: three nodes at the T")
      call checks%is_true(kind_at(mesh, [2.0_rk, 0.4_rk]) == point_boundary, "joints: boundary")
      call checks%is_true(copies(mesh, [2.0_rk, 0.4_rk]) == 2, "joints: two nodes on the boundary")
      call checks%is_true(mesh%fracture%n_tips == 6, "joints: tips")
      call checks%is_true(all(mesh%fracture%tip_fracture == [1, 1, 2, 2, 3, 4]), &
                          "joints: fractures of the tips")
   end subroutine test_crossing

   !> A window with rosettes that cuts a fracture.
   subroutine test_window(checks)
      type(checks_t), intent(inout) :: checks
      type(mesh_t) :: mesh
      type(mesh_spec_t) :: spec

      spec = mesh_spec_t(0.5_rk, 1.0_rk, 0.0_rk, 0.5_rk, 0.01_rk, 0.05_rk, is_window=.true., &
                         rosette_sectors=12, rosette_radius=0.01_rk)
      call build_mesh(spec, straight_network(reshape([0.0_rk, 0.25_rk, 0.75_rk, 0.25_rk], &
                                                     [2, 2, 1])), mesher, mesh, error)
      call checks%no_error(error, "window")
      call check_mesh(checks, mesh, 0.25_rk, 1, "window")
      call checks%is_true(mesh%fracture%n_tips == 1, "window: one tip")
      call checks%is_close(mesh%fracture%tip_radius(1), 0.01_rk, 0.0_rk, "window: rosette radius")
      call checks%is_true(mesh%fracture%tip_end(1) == 2, "window: the end of the polyline")
      call checks%is_true(count(mesh%cell_nodes == mesh%fracture%tip_node(1)) == 12, &
                          "window: cells around the tip")
      call checks%is_close(minval(mesh%fracture%cell_s), 0.5_rk, 1.0e-14_rk, &
                           "window: arc length at the edge")
      call checks%is_true(kind_at(mesh, [0.5_rk, 0.25_rk]) == point_boundary, "window: cut end")
   end subroutine test_window

   !> Errors arrive with the library's words.
   subroutine test_refusals(checks)
      type(checks_t), intent(inout) :: checks
      type(mesh_t) :: mesh
      type(mesh_spec_t) :: spec
      type(network_t) :: network
      integer(ik) :: cells(1)

      spec = mesh_spec_t(0.0_rk, 1.0_rk, 0.0_rk, 1.0_rk, 0.1_rk, 0.2_rk)
      network = straight_network(reshape([0.5_rk, 0.5_rk, 1.5_rk, 0.5_rk], [2, 2, 1]))
      call build_mesh(spec, network, mesher, mesh, error)
      call checks%fails_with(error, "fracture 1 leaves the domain", "outside")
      network%names = [text_t("west")]
      call build_mesh(spec, network, mesher, mesh, error)
      call checks%is_true(error%message == "fracture 'west' leaves the domain at (1.5, 0.5)", &
                          "a fracture with a name, without advice for the scene")
      call locate(mesher, reshape([0.5_rk, 0.5_rk], [2, 1]), cells, error)
      call checks%fails_with(error, "there is no mesh", "no mesh after a refusal")
      network%s_start = [0.0_rk, 0.0_rk]
      call build_mesh(spec, network, mesher, mesh, error)
      call checks%fails_with(error, "do not fit", "array lengths")
      network = straight_network(reshape([0.5_rk, 0.5_rk, 0.8_rk, 0.5_rk], [2, 2, 1]))
      network%first = [1, 2]
      call build_mesh(spec, network, mesher, mesh, error)
      call checks%fails_with(error, "not in order", "vertices")
   end subroutine test_refusals

   !> Cells count from 1, 0 is outside.
   subroutine test_locate(checks)
      type(checks_t), intent(inout) :: checks
      type(mesh_t) :: mesh
      real(rk), allocatable :: centres(:, :)
      integer(ik), allocatable :: cells(:)
      integer(ik) :: outside(2)
      integer :: i

      call build_mesh(mesh_spec_t(0.0_rk, 1.0_rk, 0.0_rk, 1.0_rk, 0.05_rk, 0.1_rk), &
                      straight_network(reshape([0.2_rk, 0.5_rk, 0.8_rk, 0.4_rk], [2, 2, 1])), &
                      mesher, mesh, error)
      allocate (centres(2, mesh%n_cells), cells(mesh%n_cells))
      do i = 1, mesh%n_cells
         centres(:, i) = sum(mesh%xy(:, mesh%cell_nodes(:, i)), 2)/3.0_rk
      end do
      call locate(mesher, centres, cells, error)
      call checks%no_error(error, "locate")
      call checks%is_true(all(cells == [(i, i=1, mesh%n_cells)]), "locate: centres of cells")
      call locate(mesher, reshape([1.5_rk, 0.5_rk, 0.5_rk, -0.1_rk], [2, 2]), outside, error)
      call checks%is_true(all(outside == 0), "locate: outside")
   end subroutine test_locate

   !> Growth into another fracture: the map in Fortran's indices.
   subroutine test_remesh(checks)
      type(checks_t), intent(inout) :: checks
      type(mesher_t) :: before_mesher, mesher
      type(mesh_t) :: before, mesh
      type(mesh_map_t) :: map
      type(network_t) :: network
      real(rk), allocatable :: old_areas(:), areas(:), covered(:)
      integer :: c, k, wrong

      network = straight_network(reshape([0.3_rk, 0.5_rk, 0.5_rk, 0.5_rk, &
                                          0.56_rk, 0.3_rk, 0.56_rk, 0.7_rk], [2, 2, 2]))
      call build_mesh(mesh_spec_t(0.0_rk, 1.0_rk, 0.0_rk, 1.0_rk, 0.02_rk, 0.1_rk), network, &
                      before_mesher, before, error)
      call checks%no_error(error, "remesh: before")
      network%first = [1, 4, 6]
      network%xy = reshape([0.3_rk, 0.5_rk, 0.5_rk, 0.5_rk, 0.56_rk, 0.51_rk, &
                            0.56_rk, 0.3_rk, 0.56_rk, 0.7_rk], [2, 5])
      call remesh(before_mesher, network, reshape([0.5_rk, 0.5_rk], [2, 1]), 0.08_rk, 0.02_rk, &
                  mesher, mesh, map, error)
      call checks%no_error(error, "remesh")
      call check_mesh(checks, mesh, 1.0_rk, 0, "remesh")
      call checks%is_true(kind_at(mesh, [0.56_rk, 0.51_rk]) == point_joint_t, "remesh: T")

      allocate (old_areas, source=cell_areas(before))
      allocate (areas, source=cell_areas(mesh))
      allocate (covered(before%n_cells), source=0.0_rk)
      wrong = 0
      do c = 1, mesh%n_cells
         if (map%cell_old(c) > 0) then
            covered(map%cell_old(c)) = covered(map%cell_old(c)) + areas(c)
            if (map%overlap_first(c) /= map%overlap_first(c + 1)) wrong = wrong + 1
            if (any(abs(mesh%xy(:, mesh%cell_nodes(:, c)) - &
                        before%xy(:, before%cell_nodes(:, map%cell_old(c)))) > 0.0_rk)) then
               wrong = wrong + 1
            end if
         else
            associate (first => map%overlap_first(c), last => map%overlap_first(c + 1) - 1)
               if (.not. abs(sum(map%overlap_area(first:last)) - areas(c)) &
                   <= 1.0e-12_rk*areas(c)) wrong = wrong + 1
               do k = first, last
                  associate (old => map%overlap_cell(k))
                     covered(old) = covered(old) + map%overlap_area(k)
                  end associate
               end do
            end associate
         end if
      end do
      call checks%is_true(wrong == 0, "remesh: cells are the old ones or covered by overlaps")
      call checks%is_true(all(abs(covered - old_areas) <= 1.0e-11_rk*old_areas), &
                          "remesh: old cells are covered once")

      wrong = 0
      do c = 1, mesh%fracture%n_cells
         if (map%fracture_cell_old(c) == 0) cycle
         if (mesh%fracture%cell_fracture(c) /= &
             before%fracture%cell_fracture(map%fracture_cell_old(c))) wrong = wrong + 1
      end do
      call checks%is_true(wrong == 0, "remesh: fracture cells keep their fracture")
      ! Short ones next to the halves.
      call checks%is_true(count(map%fracture_cell_old == 0) > 3, "remesh: new fracture cells")
      call checks%is_true(mesh%fracture%n_cells == before%fracture%n_cells + 1 &
                          + count(map%fracture_cell_old == 0), &
                          "remesh: new fracture cells and one in halves")

      network%xy(1, 1) = 0.31_rk
      call remesh(before_mesher, network, reshape([0.5_rk, 0.5_rk], [2, 1]), 0.08_rk, 0.02_rk, &
                  mesher, mesh, map, error)
      call checks%fails_with(error, "fracture 1 has not only grown", "remesh: moved vertices")
   end subroutine test_remesh

   !> Meshers can be moved, not copied.
   subroutine test_ownership(checks)
      type(checks_t), intent(inout) :: checks
      type(mesher_t) :: mesher, other
      type(mesh_t) :: mesh
      type(network_t) :: network
      integer(ik) :: cells(1)
      real(rk), parameter :: place(2, 1) = reshape([0.5_rk, 0.5_rk], [2, 1])

      call build_mesh(mesh_spec_t(0.0_rk, 1.0_rk, 0.0_rk, 1.0_rk, 0.5_rk, 0.5_rk), network, &
                      mesher, mesh, error)
      call transfer_mesher(mesher, other)
      call locate(other, place, cells, error)
      call checks%no_error(error, "transfer: the new owner has the mesh")
      call locate(mesher, place, cells, error)
      call checks%fails_with(error, "there is no mesh", "transfer: the old owner has none")
      mesher = other
      call locate(mesher, place, cells, error)
      call checks%fails_with(error, "there is no mesh", "assignment: no copy")
      call locate(other, place, cells, error)
      call checks%no_error(error, "assignment: the owner keeps the mesh")
   end subroutine test_ownership

end program test_mesh_builder
