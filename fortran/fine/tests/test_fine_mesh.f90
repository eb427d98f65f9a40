!> Numbering and placing of the six-node mesh, and what it refuses.
program test_fine_mesh
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use fine_mesh, only: build_fine_mesh, fine_mesh_t
   use mesh_types, only: mesh_t
   use sample_meshes, only: cracked_rectangle
   use testing_checks, only: checks_t
   implicit none(type, external)
   type(checks_t) :: checks
   type(mesh_t) :: mesh
   type(fine_mesh_t) :: fine
   type(error_t), allocatable :: error
   real(rk) :: share, height
   integer(ik) :: cell, k, a, b, n_wrong, side, corners(3)

   ! A box of 4 by 3 with a crack over boxes 2 and 3 on top of row 1: tips at x = 1 and 3.
   mesh = cracked_rectangle([0.0_rk, 4.0_rk], [0.0_rk, 3.0_rk], [4_ik, 3_ik], 1_ik, 2_ik, 3_ik)
   call build_fine_mesh(mesh, fine, error)
   call checks%no_error(error, "a cracked mesh")
   call checks%is_true(mesh%n_nodes == 20 + 12 + 1, "one node of the crack is doubled")
   call checks%is_true(mesh%n_nodes - mesh%n_faces + mesh%n_cells == 0, &
                       "Euler number of a disc with one hole")
   call checks%is_true(fine%n_nodes == mesh%n_nodes + mesh%n_faces, "a node per vertex and face")
   call checks%is_true(count(fine%tip_corner > 0) == 16, "eight elements at each tip")
   call checks%is_true(count(fine%on_boundary) == 28 &
                       .and. size(fine%boundary_faces, 2) == 14, "outer boundary")

   n_wrong = 0
   do cell = 1, fine%n_cells
      do k = 1, 3
         a = fine%cell_nodes(k, cell)
         b = fine%cell_nodes(mod(k, 3) + 1, cell)
         share = 0.5_rk
         if (fine%tip_corner(cell) == k) share = 0.25_rk
         if (fine%tip_corner(cell) == mod(k, 3) + 1) share = 0.75_rk
         if (.not. norm2(fine%xy(:, fine%cell_nodes(3 + k, cell)) - (1.0_rk - share)*fine%xy(:, a) &
                         - share*fine%xy(:, b)) < 1.0e-14_rk) n_wrong = n_wrong + 1
      end do
   end do
   call checks%is_true(n_wrong == 0, "midside nodes lie in the middle, or at the quarter points")

   call checks%is_true(fine%face_nodes(1, 1, 1) == fine%face_nodes(1, 2, 1), "a tip is one node")
   call checks%is_true(all(fine%face_nodes(2:3, 1, 1) /= fine%face_nodes(2:3, 2, 1)), &
                       "faces have their own nodes")
   call checks%is_true(all(fine%face_tip == [1, 2]), "tips at the outer ends of the fracture cells")
   call checks%is_close(fine%face_s(3, 1), 0.25_rk, 1.0e-15_rk, "quarter point after the start")
   call checks%is_close(fine%face_s(3, 2), 1.75_rk, 1.0e-15_rk, "quarter point before the end")
   do cell = 1, 2
      do side = 1, 2
         call checks%is_close(fine%xy(1, fine%face_nodes(3, side, cell)) - 1.0_rk, &
                              fine%face_s(3, cell), 1.0e-14_rk, &
                              "place of the face's middle node")
         corners = fine%cell_nodes(1:3, fine%face_cells(side, cell))
         height = sum(fine%xy(2, corners))/3.0_rk - 1.0_rk
         call checks%is_true(merge(height < 0.0_rk, height > 0.0_rk, side == 1), &
                             "side + lies to the right")
      end do
   end do

   mesh%cell_nodes(:, 5) = mesh%cell_nodes([2, 1, 3], 5)
   call build_fine_mesh(mesh, fine, error)
   call checks%fails_with(error, "element 5 at", "an inverted element is named")
   mesh%cell_nodes(:, 5) = mesh%cell_nodes([2, 1, 3], 5)
   mesh%xy(1, 7) = ieee_value(1.0_rk, ieee_quiet_nan)
   call build_fine_mesh(mesh, fine, error)
   call checks%fails_with(error, "not a finite number", "a coordinate that is no number")
   mesh = cracked_rectangle([0.0_rk, 4.0_rk], [0.0_rk, 3.0_rk], [4_ik, 3_ik], 1_ik, 2_ik, 3_ik)
   mesh%fracture%tip_node = mesh%face_nodes(:, 1)
   call build_fine_mesh(mesh, fine, error)
   call checks%fails_with(error, "joins two tips", "two tips side by side")
   call checks%finish()
end program test_fine_mesh
