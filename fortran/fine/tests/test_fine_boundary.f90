!> Bodies held and loaded at their boundary, against exact solutions that the elements contain.
program test_fine_boundary
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use exact_cracks, only: uniform_field
   use exact_fields, only: reactions
   use fine_boundary, only: add_point_force, add_side_springs, add_side_stress, &
                            add_side_traction, fine_boundary_t, free_boundary, mark_side, &
                            nearest_node
   use fine_elasticity, only: elasticity_t
   use fine_faces, only: face_conditions_t, face_jump, loaded_everywhere
   use fine_loads, only: fine_loads_t, no_loads
   use fine_model, only: fine_model_t
   use mesh_types, only: mesh_t
   use sample_meshes, only: cracked_rectangle
   use testing_checks, only: checks_t
   implicit none(type, external)
   type(checks_t) :: checks
   type(error_t), allocatable :: error
   type(mesh_t) :: mesh
   type(fine_model_t) :: model
   type(fine_boundary_t) :: boundary
   type(fine_loads_t) :: loads
   real(rk), allocatable :: displacement(:, :)  !< found [m]
   real(rk), allocatable :: exact(:, :)  !< [m]
   type(elasticity_t), parameter :: rock = elasticity_t(4.0e10_rk, 0.2_rk, 0.8_rk, .false.)
   integer(ik), parameter :: left = 1, right = 2, bottom = 3, top = 4, x = 1, y = 2

   call biaxial()
   call on_springs()
   call shear_on_points()
   call gravity(0.2_rk, 1.0e-11_rk)
   call gravity(0.4999_rk, 1.0e-9_rk)
   call lithostatic()
   call pressure_on_all_sides()
   call point_force()
   call rolling_displacement()
   call units()
   call refusals()
   call checks%finish()

contains

   !> A body of 3 m by 2 m with a crack inside, without conditions.
   subroutine set_body()
      mesh = cracked_rectangle([0.0_rk, 3.0_rk], [0.0_rk, 2.0_rk], [6_ik, 5_ik], 2_ik, 3_ik, 5_ik)
      call model%set_mesh(mesh, rock, error)
      call checks%no_error(error, "body is numbered")
   end subroutine set_body

   !> Hold one component of displacement on each of some sides, and nothing else.
   subroutine hold(sides, components)
      integer(ik), intent(in) :: sides(:), components(:)
      integer(ik) :: i

      boundary = free_boundary(model%mesh)
      do i = 1, size(sides, kind=ik)
         call mark_side(model%mesh, sides(i), components(i), boundary%prescribed)
      end do
   end subroutine hold

   !> Hold u at the origin and u_y at (3, 0) only.
   subroutine hold_points()
      boundary = free_boundary(model%mesh)
      boundary%prescribed(:, nearest_node(model%mesh, [0.0_rk, 0.0_rk])) = .true.
      boundary%prescribed(y, nearest_node(model%mesh, [3.0_rk, 0.0_rk])) = .true.
   end subroutine hold_points

   !> Set up the held body, without loads.
   subroutine prepare()
      call model%prepare(loaded_everywhere(model%mesh), error, boundary)
      call checks%no_error(error, "held body is set up")
      loads = no_loads(model%mesh)
   end subroutine prepare

   subroutine solve(name)
      character(len=*), intent(in) :: name

      call model%solve(loads, displacement, error)
      call checks%no_error(error, name//" is solved")
   end subroutine solve

   !> Displacements against the exact ones.
   subroutine compare(tolerance, name)
      real(rk), intent(in) :: tolerance  !< over the largest displacement [-]
      character(len=*), intent(in) :: name

      call checks%is_close(maxval(abs(displacement - exact))/maxval(abs(exact)), 0.0_rk, &
                           tolerance, name)
   end subroutine compare

   !> Displacements against those of a uniform stress.
   subroutine compare_uniform(stress, tolerance, name)
      real(rk), intent(in) :: stress(3)  !< xx, yy, xy [Pa]
      real(rk), intent(in) :: tolerance  !< over the largest displacement [-]
      character(len=*), intent(in) :: name
      integer(ik) :: node

      exact = displacement
      do node = 1, model%mesh%n_nodes
         exact(:, node) = uniform_field(rock, stress, model%mesh%xy(:, node))
      end do
      call compare(tolerance, name)
   end subroutine compare_uniform

   !> Rollers on the left and at the bottom, tractions on the right and on top, the crack loaded
   !! so that it does not disturb the uniform stress.
   subroutine biaxial()
      real(rk), parameter :: stress(3) = [-20.0e6_rk, 10.0e6_rk, 0.0_rk]
      real(rk), allocatable :: reaction(:, :)
      real(rk) :: energy

      call set_body()
      call hold([left, bottom], [x, y])
      call prepare()
      call add_side_traction(model%mesh, right, [stress(1), 0.0_rk], loads%force)
      call add_side_traction(model%mesh, top, [0.0_rk, stress(2)], loads%force)
      loads%traction(2, :) = stress(2)
      call solve("rollers")
      call compare_uniform(stress, 1.0e-12_rk, "biaxial stress")
      reaction = reactions(model, loads, displacement)
      call checks%is_close(sum(reaction(x, :)), -stress(1)*2.0_rk, 1.0e-4_rk, "force on the left")
      call checks%is_close(sum(reaction(y, :)), -stress(2)*3.0_rk, 1.0e-4_rk, "force at the bottom")
      call checks%is_close(maxval(abs(reaction), mask=.not. boundary%prescribed), 0.0_rk, &
                           1.0e-4_rk, "no reaction where nothing is held")
      ! Plane strain: energy density (s_xx**2 + s_yy**2 - nu (s_xx + s_yy)**2)(1 + nu)/(2 E).
      energy = (sum(stress(1:2)**2) - rock%poisson*sum(stress(1:2))**2) &
               *(1.0_rk + rock%poisson)/(2.0_rk*rock%young)*6.0_rk
      call checks%is_close(model%strain_energy(displacement)/energy, 1.0_rk, 1.0e-12_rk, "energy")
   end subroutine biaxial

   !> The same stress between rollers and springs against which larger tractions press.
   subroutine on_springs()
      real(rk), parameter :: stress(3) = [-20.0e6_rk, 10.0e6_rk, 0.0_rk]
      real(rk), parameter :: spring(2) = [2.0e10_rk, 7.0e9_rk]
      real(rk) :: corner(2)

      call set_body()
      call add_side_springs(model%mesh, right, [spring(1), 0.0_rk], model%stiffness)
      call add_side_springs(model%mesh, top, [0.0_rk, spring(2)], model%stiffness)
      call hold([left, bottom], [x, y])
      call prepare()
      corner = uniform_field(rock, stress, [3.0_rk, 2.0_rk])
      call add_side_traction(model%mesh, right, [stress(1) + spring(1)*corner(1), 0.0_rk], &
                             loads%force)
      call add_side_traction(model%mesh, top, [0.0_rk, stress(2) + spring(2)*corner(2)], &
                             loads%force)
      loads%traction(2, :) = stress(2)
      call solve("springs")
      call compare_uniform(stress, 1.0e-11_rk, "on springs")
   end subroutine on_springs

   !> Pure shear on all sides of a body held at two points only: u at the origin, u_y at (3, 0).
   subroutine shear_on_points()
      real(rk), parameter :: shear = 3.0e6_rk

      call set_body()
      call hold_points()
      call prepare()
      call add_side_traction(model%mesh, right, [0.0_rk, shear], loads%force)
      call add_side_traction(model%mesh, left, [0.0_rk, -shear], loads%force)
      call add_side_traction(model%mesh, top, [shear, 0.0_rk], loads%force)
      call add_side_traction(model%mesh, bottom, [-shear, 0.0_rk], loads%force)
      loads%traction(1, :) = shear
      call solve("held points")
      exact = displacement
      exact(x, :) = shear/rock%shear_modulus()*model%mesh%xy(y, :)
      exact(y, :) = 0.0_rk
      call compare(1.0e-11_rk, "pure shear")
      call checks%is_close(maxval(abs(reactions(model, loads, displacement))), 0.0_rk, 1.0e-3_rk, &
                           "held points of a balanced body carry nothing")
   end subroutine shear_on_points

   !> A column between smooth walls under its own weight: (lambda + 2 mu) u_y'' = rho g, with
   !! u_y = 0 at the bottom and no stress on top, is quadratic.
   subroutine gravity(poisson, tolerance)
      real(rk), intent(in) :: poisson, tolerance
      real(rk), parameter :: weight = 2700.0_rk*9.81_rk, height = 2.0_rk
      real(rk), allocatable :: reaction(:, :)
      real(rk) :: modulus
      type(elasticity_t) :: elasticity

      elasticity = elasticity_t(4.0e10_rk, poisson, 0.0_rk, .false.)
      mesh = cracked_rectangle([0.0_rk, 3.0_rk], [0.0_rk, height], [4_ik, 5_ik], 1_ik, 1_ik, 0_ik)
      call model%set_mesh(mesh, elasticity, error)
      call hold([left, right, bottom], [x, x, y])
      call prepare()
      loads%body_force = [0.0_rk, -weight]
      call solve("gravity")
      modulus = elasticity%lame_lambda() + 2.0_rk*elasticity%shear_modulus()
      exact = displacement
      exact(x, :) = 0.0_rk
      exact(y, :) = weight/modulus*model%mesh%xy(y, :)*(0.5_rk*model%mesh%xy(y, :) - height)
      call compare(tolerance, "gravity")
      reaction = reactions(model, loads, displacement)
      call checks%is_close(sum(reaction(y, :))/(weight*6.0_rk), 1.0_rk, 1.0e-9_rk, &
                           "the bottom carries the weight")
   end subroutine gravity

   !> In-situ stress that grows with depth as the weight does: nothing moves, cracked or not, as
   !! long as the crack's faces carry it.
   subroutine lithostatic()
      real(rk), parameter :: weight = 2700.0_rk*9.81_rk, sideways = 0.4_rk, crack_y = 0.8_rk

      call set_body()
      call hold([left, right, bottom], [x, x, y])
      call prepare()
      loads%body_force = [0.0_rk, -weight]
      loads%initial_stress(2, :) = weight*(model%mesh%xy(y, :model%mesh%n_vertices) - 2.0_rk)
      loads%initial_stress(1, :) = sideways*loads%initial_stress(2, :)
      loads%traction(2, :) = weight*(crack_y - 2.0_rk)
      call solve("in-situ stress")
      ! The scale is the settlement that the weight alone would give.
      call checks%is_close(maxval(abs(displacement))*rock%young/(weight*4.0_rk), 0.0_rk, &
                           1.0e-12_rk, "in-situ stress in equilibrium moves nothing")
   end subroutine lithostatic

   !> The same pressure on all sides and in the crack: uniform compression.
   subroutine pressure_on_all_sides()
      real(rk), parameter :: pressure = 7.0e6_rk
      integer(ik) :: side

      call set_body()
      call hold_points()
      call prepare()
      do side = left, top
         call add_side_stress(model%mesh, side, -pressure, 0.0_rk, loads%force)
      end do
      loads%fluid_pressure = pressure
      call solve("pressure")
      call compare_uniform([-pressure, -pressure, 0.0_rk], 1.0e-12_rk, "pressure")
   end subroutine pressure_on_all_sides

   !> A concentrated force: balance of forces and moments, and energy = work/2.
   subroutine point_force()
      real(rk), parameter :: push(2) = [3.0e5_rk, -5.0e5_rk], place(2) = [1.5_rk, 2.0_rk]
      real(rk), allocatable :: reaction(:, :)
      real(rk) :: moment
      integer(ik) :: node

      call set_body()
      call hold([bottom, bottom], [x, y])
      call prepare()
      call add_point_force(model%mesh, place, push, loads%force)
      call solve("point force")
      reaction = reactions(model, loads, displacement)
      moment = place(1)*push(2) - place(2)*push(1)
      do node = 1, model%mesh%n_nodes
         moment = moment + model%mesh%xy(1, node)*reaction(2, node) &
                  - model%mesh%xy(2, node)*reaction(1, node)
      end do
      call checks%is_close(maxval(abs(sum(reaction, dim=2) + push)), 0.0_rk, 1.0e-4_rk, &
                           "balance of forces")
      call checks%is_close(moment, 0.0_rk, 1.0e-3_rk, "balance of moments")
      node = nearest_node(model%mesh, place)
      call checks%is_close(2.0_rk*model%strain_energy(displacement) &
                           /dot_product(push, displacement(:, node)), 1.0_rk, 1.0e-11_rk, &
                           "energy is half the work")
   end subroutine point_force

   !> A given component that is not zero, the other one free: uniaxial stress by pulling.
   subroutine rolling_displacement()
      real(rk), parameter :: stretch = 1.0e-3_rk
      integer(ik) :: node

      call set_body()
      call hold([left, right], [x, x])
      boundary%prescribed(y, nearest_node(model%mesh, [0.0_rk, 0.0_rk])) = .true.
      call prepare()
      do node = 1, model%mesh%n_nodes
         loads%boundary_displacement(:, node) = [stretch*model%mesh%xy(1, node)/3.0_rk, 0.0_rk]
      end do
      call solve("pulled body")
      call compare_uniform([rock%crack_modulus()*stretch/3.0_rk, 0.0_rk, 0.0_rk], 1.0e-12_rk, &
                           "pulled body")
   end subroutine rolling_displacement

   !> The same body in other units of length and stress gives the same displacements over length.
   subroutine units()
      real(rk), parameter :: lengths(3) = [1.0_rk, 1.0e-6_rk, 1.0e4_rk]
      real(rk), parameter :: stresses(3) = [1.0_rk, 1.0e9_rk, 1.0e-9_rk]
      integer(ik) :: i

      do i = 1, size(lengths)
         mesh = cracked_rectangle([0.0_rk, 3.0_rk]*lengths(i), [0.0_rk, 2.0_rk]*lengths(i), &
                                  [6_ik, 5_ik], 2_ik, 3_ik, 5_ik)
         call model%set_mesh(mesh, elasticity_t(stresses(i), 0.3_rk, 0.0_rk, .true.), error)
         call hold([bottom, bottom], [x, y])
         call prepare()
         call add_side_traction(model%mesh, top, [0.5_rk, 1.0_rk]*stresses(i), loads%force)
         call solve("other units")
         displacement = displacement/lengths(i)
         if (i == 1) exact = displacement
         call compare(1.0e-11_rk, "units")
      end do
   end subroutine units

   !> Bodies that could move, as a whole or in part.
   subroutine refusals()
      type(face_conditions_t) :: conditions

      call set_body()
      boundary = fine_boundary_t()
      call model%prepare(loaded_everywhere(model%mesh), error, boundary)
      call checks%fails_with(error, "not been set", "no boundary conditions")
      boundary = free_boundary(model%mesh)
      call model%prepare(loaded_everywhere(model%mesh), error, boundary)
      call checks%fails_with(error, "can move as a rigid body", "floating body")
      call mark_side(model%mesh, left, x, boundary%prescribed)
      call model%prepare(loaded_everywhere(model%mesh), error, boundary)
      call checks%fails_with(error, "can move as a rigid body", "body on rollers on one side")
      boundary = free_boundary(model%mesh)
      boundary%prescribed(:, nearest_node(model%mesh, [0.0_rk, 0.0_rk])) = .true.
      call model%prepare(loaded_everywhere(model%mesh), error, boundary)
      call checks%fails_with(error, "can move as a rigid body", "body on a hinge")

      ! A crack from side to side cuts off the upper half, unless its faces are tied.
      mesh = cracked_rectangle([0.0_rk, 3.0_rk], [0.0_rk, 2.0_rk], [6_ik, 4_ik], 2_ik, 1_ik, 6_ik)
      call model%set_mesh(mesh, rock, error)
      call hold([bottom, bottom], [x, y])
      conditions = loaded_everywhere(model%mesh)
      call model%prepare(conditions, error, boundary)
      call checks%fails_with(error, "can move as a rigid body", "cut body")
      conditions%condition = face_jump
      call model%prepare(conditions, error, boundary)
      call checks%no_error(error, "cut body with tied faces")
   end subroutine refusals

end program test_fine_boundary
