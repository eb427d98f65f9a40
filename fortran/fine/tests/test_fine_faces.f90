!> Conditions on fracture faces against fields that hold them exactly: two blocks in contact that
!! slide and turn on each other under a uniform stress.
program test_fine_faces
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use exact_cracks, only: uniform_field
   use fine_elasticity, only: elasticity_t
   use fine_faces, only: face_conditions_t, face_jump, face_loaded, face_slip, loaded_everywhere
   use fine_loads, only: fine_loads_t, no_loads
   use fine_model, only: fine_model_t
   use mesh_types, only: mesh_t
   use sample_meshes, only: cracked_rectangle, rotate_mesh
   use testing_checks, only: checks_t
   implicit none(type, external)
   type(checks_t) :: checks
   type(error_t), allocatable :: error
   type(mesh_t) :: mesh
   real(rk), parameter :: angle = 0.4_rk  ! of the crack with the x axis [rad]
   real(rk), parameter :: tau(2) = [cos(angle), sin(angle)], n(2) = [-sin(angle), cos(angle)]
   real(rk), parameter :: stress(3) = [-3.0e6_rk, -5.0e6_rk, 1.5e6_rk]
   real(rk), parameter :: dilation = 0.15_rk, slip = 3.0e-5_rk, pressure = 1.0e6_rk
   real(rk), parameter :: turn = 2.0e-5_rk  ! relative rotation of the blocks [rad]
   logical :: opposed = .false.  ! the crack is two fractures that run towards each other
   integer(ik) :: i

   do i = 1, 2
      opposed = i == 2
      call compare("loaded", face_loaded, 0.0_rk)
      call compare("jump", face_jump, 1.0_rk)
      call compare("slip", face_slip, 0.0_rk)
   end do
   call mixed()
   call inside()
   call refusals()
   call checks%finish()

contains

   !> A block cut through along a line at an angle: below it u = uniform field, above it the same
   !! plus a jump.
   subroutine compare(name, condition, turning)
      character(len=*), intent(in) :: name
      integer(ik), intent(in) :: condition
      real(rk), intent(in) :: turning  !< 1 if the jump also has a rotation
      type(fine_model_t) :: model
      type(fine_loads_t) :: loads
      type(face_conditions_t) :: conditions
      real(rk), allocatable :: displacement(:, :), exact(:, :)

      call cut_block(model, exact, turning)
      conditions = loaded_everywhere(model%mesh)
      conditions%condition = condition
      conditions%dilation = dilation
      call model%prepare(conditions, error)
      call checks%no_error(error, name//" is set up")
      call block_loads(model, exact, condition, turning, loads)
      call model%solve(loads, displacement, error)
      call checks%no_error(error, name//" is solved")
      call checks%is_close(maxval(abs(displacement - exact)), 0.0_rk, &
                           1.0e-12_rk*maxval(abs(exact)), name)
   end subroutine compare

   !> Mesh and exact displacements.
   subroutine cut_block(model, exact, turning)
      type(fine_model_t), intent(inout) :: model
      real(rk), allocatable, intent(out) :: exact(:, :)
      real(rk), intent(in) :: turning
      type(error_t), allocatable :: error
      integer(ik) :: cell, k

      mesh = cracked_rectangle([-1.0_rk, 1.0_rk], [-1.0_rk, 1.0_rk], [5_ik, 4_ik], 2_ik, 1_ik, 5_ik)
      if (opposed) call turn_cells(mesh, 4_ik)
      call rotate_mesh(mesh, angle, .false.)
      call model%set_mesh(mesh, elasticity_t(4.0e10_rk, 0.2_rk, 0.8_rk, .false.), error)
      call checks%no_error(error, "a block that is cut through")
      allocate (exact(2, model%mesh%n_nodes))
      do k = 1, model%mesh%n_nodes
         exact(:, k) = uniform_field(model%elasticity, stress, model%mesh%xy(:, k))
      end do
      do cell = 1, model%mesh%n_cells
         associate (nodes => model%mesh%cell_nodes(:, cell))
            if (dot_product(n, sum(model%mesh%xy(:, nodes(1:3)), dim=2)) < 0.0_rk) cycle
            do k = 1, 6
               exact(:, nodes(k)) = uniform_field(model%elasticity, stress, &
                                                  model%mesh%xy(:, nodes(k))) &
                                    + jump_at(model%mesh%xy(:, nodes(k)), turning)
            end do
         end associate
      end do
   end subroutine cut_block

   !> Make a second fracture of the cells from `first` on, which runs the other way: its sides, and
   !! tau and n, are exchanged, but not the components of tractions and jumps.
   subroutine turn_cells(mesh, first)
      type(mesh_t), intent(inout) :: mesh
      integer(ik), intent(in) :: first

      associate (fracture => mesh%fracture)
         fracture%cell_fracture(first:) = 2
         fracture%cell_points(:, first:) = fracture%cell_points([2, 1], first:)
         fracture%cell_faces(:, first:) = fracture%cell_faces([2, 1], first:)
         fracture%cell_s(:, first:) = fracture%cell_s(2, size(fracture%cell_s, 2)) &
                                      - fracture%cell_s([2, 1], first:)
      end associate
   end subroutine turn_cells

   !> Rigid motion of the upper block relative to the lower one.
   pure function jump_at(xy, turning) result(jump)
      real(rk), intent(in) :: xy(2), turning
      real(rk) :: jump(2)

      jump = slip*(tau + dilation*n) + turning*turn*[-xy(2), xy(1)]
   end function jump_at

   !> Loads that go with the exact field; where a condition leaves a value without meaning, a wrong
   !! one.
   subroutine block_loads(model, exact, condition, turning, loads)
      type(fine_model_t), intent(in) :: model
      real(rk), intent(in) :: exact(:, :)
      integer(ik), intent(in) :: condition
      real(rk), intent(in) :: turning
      type(fine_loads_t), intent(out) :: loads
      real(rk) :: total(2), jump(2)
      integer(ik) :: cell, k

      loads = no_loads(model%mesh)
      loads%boundary_displacement = exact
      loads%fluid_pressure = pressure
      total = matmul(reshape([stress(1), stress(3), stress(3), stress(2)], [2, 2]), n)
      loads%traction(1, :) = dot_product(total, tau)
      loads%traction(2, :) = dot_product(total, n) + pressure
      if (condition == face_slip) then
         ! Only f_tau + dilation*f_n does work.
         loads%traction(2, :) = loads%traction(2, :) + 4.0e6_rk
         loads%traction(1, :) = loads%traction(1, :) - dilation*4.0e6_rk
      else if (condition == face_jump) then
         loads%traction = 9.0e6_rk
         do cell = 1, model%mesh%fracture%n_cells
            do k = 1, 3
               jump = jump_at(model%mesh%xy(:, model%mesh%face_nodes(k, 1, cell)), turning)
               loads%jump(:, k, cell) = [dot_product(jump, tau), dot_product(jump, n)]
            end do
         end do
      else
         loads%jump = 1.0_rk
      end if
   end subroutine block_loads

   !> All three conditions on one fracture, each consistent with the same field.
   subroutine mixed()
      type(fine_model_t) :: model
      type(fine_loads_t) :: loads, jumps
      type(face_conditions_t) :: conditions
      real(rk), allocatable :: displacement(:, :), exact(:, :)

      call cut_block(model, exact, 0.0_rk)
      conditions = loaded_everywhere(model%mesh)
      conditions%condition = [face_loaded, face_jump, face_slip, face_slip, face_loaded]
      conditions%dilation = dilation
      call model%prepare(conditions, error)
      call block_loads(model, exact, face_loaded, 0.0_rk, loads)
      call block_loads(model, exact, face_jump, 0.0_rk, jumps)
      loads%jump = jumps%jump
      call model%solve(loads, displacement, error)
      call checks%no_error(error, "mixed conditions are solved")
      call checks%is_close(maxval(abs(displacement - exact)), 0.0_rk, &
                           1.0e-12_rk*maxval(abs(exact)), "mixed conditions")
      call checks%is_true(count(model%constraints%pair_condition == face_jump) == 3, &
                          "jump holds at both ends of its cell")
      call checks%is_true(count(model%constraints%pair_condition == face_slip) == 4, &
                          "slip holds where no jump is given")
   end subroutine mixed

   !> A crack with two tips held together by zero jumps is no crack.
   subroutine inside()
      type(fine_model_t) :: model
      type(fine_loads_t) :: loads
      type(face_conditions_t) :: conditions
      real(rk), allocatable :: displacement(:, :)
      real(rk) :: exact(2), largest
      integer(ik) :: node

      mesh = cracked_rectangle([-1.0_rk, 1.0_rk], [-1.0_rk, 1.0_rk], [6_ik, 6_ik], 3_ik, 3_ik, 4_ik)
      call model%set_mesh(mesh, elasticity_t(4.0e10_rk, 0.2_rk, 0.8_rk, .true.), error)
      conditions = loaded_everywhere(model%mesh)
      conditions%condition = face_jump
      call model%prepare(conditions, error)
      loads = no_loads(model%mesh)
      do node = 1, model%mesh%n_nodes
         loads%boundary_displacement(:, node) = uniform_field(model%elasticity, stress, &
                                                              model%mesh%xy(:, node))
      end do
      call model%solve(loads, displacement, error)
      call checks%no_error(error, "closed crack is solved")
      largest = 0.0_rk
      do node = 1, model%mesh%n_nodes
         exact = uniform_field(model%elasticity, stress, model%mesh%xy(:, node))
         largest = max(largest, norm2(displacement(:, node) - exact))
      end do
      call checks%is_close(largest, 0.0_rk, 1.0e-12_rk*maxval(abs(displacement)), &
                           "a crack held closed")
   end subroutine inside

   subroutine refusals()
      type(fine_model_t) :: model
      type(face_conditions_t) :: conditions
      real(rk), allocatable :: exact(:, :)

      call cut_block(model, exact, 0.0_rk)
      call model%prepare(conditions, error)
      call checks%fails_with(error, "not been set", "no conditions")
      conditions = loaded_everywhere(model%mesh)
      conditions%condition(2) = 7
      call model%prepare(conditions, error)
      call checks%fails_with(error, "unknown face condition", "a condition that does not exist")
      conditions%condition = [face_loaded]
      call model%prepare(conditions, error)
      call checks%fails_with(error, "wrong number", "conditions of another mesh")
   end subroutine refusals

end program test_fine_faces
