!> Scenes on polygons and discs, with tractions along sides, gravity and a stress that grows
!! downwards, against exact solutions.
program test_mechanics_bodies
   use base_errors, only: error_t
   use base_kinds, only: ik, pi, rk
   use base_plane, only: triangle_area
   use base_timers, only: timers_t
   use mechanics_fields, only: cell_stress
   use mechanics_simulation, only: mechanics_simulation_t
   use scene_heat, only: temperature_t
   use scene_namelist, only: resolve_defaults
   use scene_outline, only: outline_of_scene, outline_t
   use scene_types, only: boundary_part_t, fracture_t, restraint_t, scene_t
   use testing_checks, only: checks_t
   implicit none(type, external)
   real(rk), parameter :: young = 2.0e9_rk, poisson = 0.3_rk
   real(rk), parameter :: round_off = 1.0e-10_rk  !< of solutions that the elements hold exactly
   type(checks_t) :: checks
   type(scene_t) :: scene

   call check_outline()
   call check_column()
   call check_in_situ()
   call check_pure_shear()
   call check_disc()
   call check_rim()
   call check_arcs()
   call check_temperature()
   call checks%finish()

contains

   !> Rock, and nothing else.
   function bare_scene(shape) result(scene)
      character(len=*), intent(in) :: shape
      type(scene_t) :: scene

      scene%domain%shape = shape
      scene%material%young = young
      scene%material%poisson = poisson
      allocate (scene%fractures(0), scene%point_loads(0), scene%restraints(0), scene%parts(0))
   end function bare_scene

   !> A polygon in a box; the corners in the scene's order.
   function polygon_scene(x, y, size_boundary) result(scene)
      real(rk), intent(in) :: x(:), y(:)  !< [m]
      real(rk), intent(in) :: size_boundary  !< [m]
      type(scene_t) :: scene

      scene = bare_scene("polygon")
      scene%domain%x = x
      scene%domain%y = y
      scene%domain%x_min = minval(x)
      scene%domain%x_max = maxval(x)
      scene%domain%y_min = minval(y)
      scene%domain%y_max = maxval(y)
      scene%discretization%size_boundary = size_boundary
   end function polygon_scene

   pure function part(edges, held, normal, shear) result(side)
      integer(ik), intent(in) :: edges(:)
      logical, intent(in) :: held(2)
      real(rk), intent(in) :: normal, shear  !< [Pa]
      type(boundary_part_t) :: side

      side%edges = edges
      side%displacement_given = held
      side%normal_traction = normal
      side%shear_traction = shear
   end function part

   !> State of a scene at load factor 1.
   subroutine solve(scene, simulation, name)
      type(scene_t), intent(in) :: scene
      type(mechanics_simulation_t), intent(out) :: simulation
      character(len=*), intent(in) :: name
      type(scene_t) :: whole
      type(timers_t) :: timers
      type(error_t), allocatable :: error

      call timers%begin()
      whole = scene
      call resolve_defaults(whole)
      call simulation%begin(whole, timers, error)
      if (.not. allocated(error)) call simulation%respond(1.0_rk, timers, error)
      call checks%no_error(error, name)
   end subroutine solve

   !> Largest difference of the displacements from known ones [m].
   function largest_error(simulation, exact) result(error)
      type(mechanics_simulation_t), intent(in) :: simulation
      real(rk), intent(in) :: exact(:, :)  !< (2, nodes) [m]
      real(rk) :: error

      error = maxval(abs(simulation%body%displacement - exact))
   end function largest_error

   !> Given clockwise, the corners are turned round and keep the sides of their edges.
   subroutine check_outline()
      type(outline_t) :: outline
      integer(ik) :: k, next
      real(rk) :: middle(2)

      scene = polygon_scene([0.0_rk, 0.0_rk, 1.0_rk, 3.0_rk], [0.0_rk, 1.0_rk, 1.0_rk, 0.0_rk], &
                            0.5_rk)
      scene%parts = [part([1_ik], [.false., .false.], 0.0_rk, 0.0_rk), &
                     part([3_ik], [.false., .false.], 0.0_rk, 0.0_rk)]
      outline = outline_of_scene(scene)
      do k = 1, 4
         next = mod(k, 4_ik) + 1_ik
         middle = 0.5_rk*(outline%corners(:, k) + outline%corners(:, next))
         select case (outline%edge_side(k))
         case (1)
            call checks%is_close(norm2(middle - [0.0_rk, 0.5_rk]), 0.0_rk, round_off, "edge 1")
         case (2)
            call checks%is_close(norm2(middle - [2.0_rk, 0.5_rk]), 0.0_rk, round_off, "edge 3")
         case default
            call checks%is_true(outline%edge_side(k) == 3, "the others are free")
         end select
      end do
      call checks%is_true(count(outline%edge_side == 3) == 2, "two of them")
   end subroutine check_outline

   !> A column between rollers under its own weight: u_y = w/M (y**2/2 - H y), with the weight w
   !! per volume and the oedometric modulus M. The load factor does not scale the weight.
   subroutine check_column()
      real(rk), parameter :: height = 3.0_rk, weight = 2500.0_rk*9.81_rk
      real(rk), parameter :: oedometric = young*(1.0_rk - poisson) &
                             /((1.0_rk + poisson)*(1.0_rk - 2.0_rk*poisson))
      type(mechanics_simulation_t) :: simulation
      type(timers_t) :: timers
      type(error_t), allocatable :: error
      real(rk), allocatable :: exact(:, :)

      ! Clockwise; the left wall consists of two edges.
      scene = polygon_scene([0.0_rk, 0.0_rk, 0.0_rk, 1.0_rk, 1.0_rk], &
                            [0.0_rk, 1.2_rk, height, height, 0.0_rk], 0.5_rk)
      scene%parts = [part([1_ik, 2_ik, 4_ik], [.true., .false.], 0.0_rk, 0.0_rk), &
                     part([5_ik], [.false., .true.], 0.0_rk, 0.0_rk)]
      scene%material%density = 2500.0_rk
      scene%gravity = [0.0_rk, -9.81_rk]
      call solve(scene, simulation, "column")
      exact = 0.0_rk*simulation%body%displacement
      exact(2, :) = weight/oedometric*(0.5_rk*simulation%body%model%mesh%xy(2, :)**2 &
                                       - height*simulation%body%model%mesh%xy(2, :))
      call checks%is_close(largest_error(simulation, exact)/maxval(abs(exact)), 0.0_rk, round_off, &
                           "a column under its own weight")
      call timers%begin()
      call simulation%respond(0.0_rk, timers, error)
      call checks%is_close(largest_error(simulation, exact)/maxval(abs(exact)), 0.0_rk, round_off, &
                           "at load factor 0 too")
   end subroutine check_column

   !> A stress that carries the weight leaves a body with oblique edges, a notch and a crack as it
   !! is: no displacements but those of rounding.
   subroutine check_in_situ()
      type(mechanics_simulation_t) :: simulation
      real(rk) :: stress_scale

      scene = polygon_scene([0.0_rk, 2.0_rk, 1.5_rk, 1.0_rk, 0.8_rk, 0.2_rk], &
                            [0.0_rk, 0.3_rk, 1.7_rk, 0.9_rk, 2.0_rk, 1.8_rk], 0.3_rk)
      scene%restraints = [restraint_t(x=0.0_rk, y=0.0_rk, displacement_given=[.true., .true.]), &
                          restraint_t(x=2.0_rk, y=0.3_rk, displacement_given=[.false., .true.])]
      scene%material%density = 2500.0_rk
      scene%gravity = [0.0_rk, -9.81_rk]
      scene%in_situ%stress = [-3.0e6_rk, -5.0e6_rk, 0.7e6_rk]
      scene%in_situ%per_y = [9.0e3_rk, 2500.0_rk*9.81_rk]
      scene%in_situ%y_datum = 40.0_rk
      scene%fractures = [fracture_t(name="f", law="friction", friction=0.6_rk, &
                                    x=[0.4_rk, 0.7_rk], y=[0.5_rk, 0.6_rk])]
      scene%discretization%size_fracture = 0.1_rk
      call solve(scene, simulation, "in situ")
      stress_scale = 5.0e6_rk
      call checks%is_close(maxval(abs(simulation%body%displacement))*young/stress_scale, 0.0_rk, &
                           round_off, "stress in situ that carries the weight moves nothing")
   end subroutine check_in_situ

   !> Shear tractions of alternating sign around a square: the stress is xy alone.
   subroutine check_pure_shear()
      real(rk), parameter :: shear = 1.0e6_rk, modulus = young/(2.0_rk*(1.0_rk + poisson))
      type(mechanics_simulation_t) :: simulation
      real(rk), allocatable :: exact(:, :)

      scene = bare_scene("rectangle")
      scene%domain%x_max = 1.0_rk
      scene%domain%y_max = 1.0_rk
      scene%discretization%size_boundary = 0.4_rk
      scene%sides%shear_traction = [shear, shear, -shear, -shear]
      scene%restraints = [restraint_t(displacement_given=[.true., .true.]), &
                          restraint_t(x=1.0_rk, displacement_given=[.false., .true.])]
      call solve(scene, simulation, "pure shear")
      exact = 0.0_rk*simulation%body%displacement
      exact(1, :) = shear/modulus*simulation%body%model%mesh%xy(2, :)
      call checks%is_close(largest_error(simulation, exact)/maxval(abs(exact)), 0.0_rk, round_off, &
                           "pure shear")
   end subroutine check_pure_shear

   !> A linear change of temperature strains a free body without stress, also next to a crack: u has
   !! the strain e = (1 + nu) b_s/3 theta, and in plane stress b_s/3 theta. A uniform one in a held
   !! body gives the stress -K_dr b_s theta; a front has its heat, however thin.
   subroutine check_temperature()
      real(rk), parameter :: bulk = young/(3.0_rk*(1.0_rk - 2.0_rk*poisson)), expansion = 3.0e-5_rk
      type(mechanics_simulation_t) :: simulation
      real(rk), allocatable :: exact(:, :), stress(:, :)
      real(rk) :: scale
      integer :: k

      scene = bare_scene("rectangle")
      scene%domain%x_max = 1.0_rk
      scene%domain%y_max = 1.0_rk
      scene%discretization%size_boundary = 0.3_rk
      scene%material%heat_expansion = expansion
      scene%restraints = [restraint_t(displacement_given=[.true., .true.]), &
                          restraint_t(x=1.0_rk, displacement_given=[.false., .true.])]
      do k = 1, 2
         scene%temperature = temperature_t(change=-50.0_rk, per_metre=[20.0_rk, -30.0_rk], &
                                           datum=[0.5_rk, 0.25_rk])
         scale = expansion/3.0_rk
         if (k == 1) scale = (1.0_rk + poisson)*scale
         scene%material%plane_stress = k == 2
         call solve(scene, simulation, "linear temperature")
         exact = 0.0_rk*simulation%body%displacement
         associate (x => simulation%body%model%mesh%xy(1, :), &
                    y => simulation%body%model%mesh%xy(2, :), t => scene%temperature)
            associate (at_origin => t%at([0.0_rk, 0.0_rk]), g => t%per_metre)
               exact(1, :) = at_origin*x + 0.5_rk*g(1)*(x**2 - y**2) + g(2)*x*y
               exact(2, :) = at_origin*y + 0.5_rk*g(2)*(y**2 - x**2) + g(1)*x*y
               ! No displacement in y at the second restraint.
               exact(1, :) = exact(1, :) - 0.5_rk*g(2)*y
               exact(2, :) = exact(2, :) + 0.5_rk*g(2)*x
            end associate
         end associate
         exact = scale*exact
         call checks%is_close(largest_error(simulation, exact)/maxval(abs(exact)), 0.0_rk, &
                              round_off, "linear temperature in a free body")
      end do
      scene%material%plane_stress = .false.
      scene%temperature = temperature_t(change=-50.0_rk)
      scene%sides%displacement_given(1) = .true.
      scene%sides%displacement_given(2) = .true.
      deallocate (scene%restraints)
      allocate (scene%restraints(0))
      call solve(scene, simulation, "held")
      stress = cell_stress(simulation%body)
      call checks%is_close(maxval(abs(stress(:2, :)/(50.0_rk*bulk*expansion) - 1.0_rk)), 0.0_rk, &
                           round_off, "tension of a held body that is cooled")
      scene%temperature = temperature_t(face_change=-50.0_rk, face=[1.0_rk, 0.0_rk], &
                                        face_inward=pi, face_depth=0.05_rk)
      call solve(scene, simulation, "front")
      associate (mesh => simulation%body%model%mesh, t => simulation%body%loads%heat_pressure)
         call checks%is_close(sum([(triangle_area(mesh%xy(:, mesh%cell_nodes(:3, k))) &
                                    *sum(t(:, k))/3.0_rk, k=1, mesh%n_cells)]), &
                              -50.0_rk*0.05_rk/sqrt(pi), 1.0e-4_rk, "heat drawn through a face")
      end associate
   end subroutine check_temperature

   !> Pressure all round a disc: u_r = -p (1 + nu)(1 - 2 nu) r/E in plane strain.
   subroutine check_disc()
      real(rk), parameter :: pressure = 1.0e6_rk
      real(rk), parameter :: centre(2) = [0.3_rk, -0.2_rk]
      type(mechanics_simulation_t) :: simulation
      type(boundary_part_t) :: rim
      real(rk), allocatable :: exact(:, :)

      scene = disc_scene(centre, 0.7_rk)
      rim%whole_rim = .true.
      rim%normal_traction = -pressure
      scene%parts = [rim]
      call solve(scene, simulation, "disc")
      associate (xy => simulation%body%model%mesh%xy)
         exact = -pressure*(1.0_rk + poisson)*(1.0_rk - 2.0_rk*poisson)/young &
                 *(xy - spread(centre, 2, size(xy, 2)))
      end associate
      call checks%is_close(largest_error(simulation, exact)/maxval(abs(exact)), 0.0_rk, round_off, &
                           "a disc under pressure")
   end subroutine check_disc

   !> However small the cells are, the rim of a disc has no more corners than a polygon may have:
   !! each pair of its edges is compared.
   subroutine check_rim()
      type(outline_t) :: outline

      scene = disc_scene([0.0_rk, 0.0_rk], 42.0_rk)
      scene%discretization%size_boundary = 1.0e-5_rk
      outline = outline_of_scene(scene)
      call checks%is_true(size(outline%corners, 2) == 2000, "corners of a disc")
   end subroutine check_rim

   !> Held at its centre, and in y beside it.
   function disc_scene(centre, radius) result(scene)
      real(rk), intent(in) :: centre(2), radius  !< [m]
      type(scene_t) :: scene

      scene = bare_scene("disc")
      scene%domain%x_centre = centre(1)
      scene%domain%y_centre = centre(2)
      scene%domain%radius = radius
      scene%domain%x_min = centre(1) - radius
      scene%domain%x_max = centre(1) + radius
      scene%domain%y_min = centre(2) - radius
      scene%domain%y_max = centre(2) + radius
      scene%discretization%size_boundary = 0.2_rk*radius
      scene%restraints = [restraint_t(x=centre(1), y=centre(2), &
                                      displacement_given=[.true., .true.]), &
                          restraint_t(x=centre(1) + 0.5_rk*radius, y=centre(2), &
                                      displacement_given=[.false., .true.])]
   end function disc_scene

   !> Pressure on two opposite arcs of half angle a, as in a Brazilian test: in the centre the
   !! stress is 2 p/pi (sin 2a - a) across the load and -2 p/pi (sin 2a + a) along it (Hondros
   !! 1959). The mean of the elements at the centre of a polygon of 256 corners.
   subroutine check_arcs()
      real(rk), parameter :: pressure = 1.0e6_rk, half = 10.0_rk*pi/180.0_rk
      type(mechanics_simulation_t) :: simulation
      type(boundary_part_t) :: arc
      real(rk), allocatable :: stress(:, :)
      real(rk) :: mean(2), across, along
      integer(ik) :: cell, n

      scene = disc_scene([0.0_rk, 0.0_rk], 1.0_rk)
      scene%discretization%size_boundary = 0.07_rk
      arc%normal_traction = -pressure
      arc%arc = [0.5_rk*pi - half, 0.5_rk*pi + half]
      scene%parts = [arc, arc]
      scene%parts(2)%arc = [-0.5_rk*pi - half, -0.5_rk*pi + half]
      call solve(scene, simulation, "arcs")
      stress = cell_stress(simulation%body)
      mean = 0.0_rk
      n = 0
      do cell = 1, simulation%body%mesh%n_cells
         associate (nodes => simulation%body%mesh%cell_nodes(:, cell))
            if (minval(norm2(simulation%body%mesh%xy(:, nodes), dim=1)) > 1.0e-9_rk) cycle
         end associate
         mean = mean + stress(1:2, cell)
         n = n + 1_ik
      end do
      mean = mean/n
      across = 2.0_rk*pressure/pi*(sin(2.0_rk*half) - half)
      along = -2.0_rk*pressure/pi*(sin(2.0_rk*half) + half)
      call checks%is_close(mean(1)/across, 1.0_rk, 1.0e-2_rk, "stress across the load")
      call checks%is_close(mean(2)/along, 1.0_rk, 1.0e-2_rk, "stress along the load")
   end subroutine check_arcs

end program test_mechanics_bodies
