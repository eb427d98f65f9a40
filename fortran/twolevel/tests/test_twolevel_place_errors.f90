!> Errors by the place of a well in the rock: they hold for the exact fields of two sources, one at
!! the well and one at the centre of its cell, also before a side, and are not far too large.
program test_twolevel_place_errors
   use base_kinds, only: ik, pi, rk
   use base_plane, only: norm2
   use coarse_rock, only: new_rock, solid_t
   use report_rows, only: probe_row_t
   use scene_types, only: fluid_t, injection_t, material_t, probe_t, scene_t
   use testing_checks, only: checks_t
   use twolevel_place_errors, only: add_well_places
   use twolevel_problem, only: coarse_problem_t
   implicit none(type, external)

   integer, parameter :: directions = 24
   real(rk), parameter :: far = 100.0_rk  ! half of the body [m]
   real(rk), parameter :: volume = 2.0e-3_rk, time = 3.0e4_rk  ! [m2], [s]
   real(rk), parameter :: shift(2) = [0.08_rk, -0.05_rk]  ! of the well from the centre [m]
   type(checks_t) :: checks
   type(scene_t) :: scene
   type(coarse_problem_t) :: problem
   type(probe_row_t) :: row
   type(solid_t) :: solid
   real(rk), dimension(directions) :: p, u  ! exact changes [Pa], [m]
   real(rk), parameter :: distances(4) = [1.0_rk, 3.0_rk, 8.0_rk, 20.0_rk]
   character(len=24) :: name
   integer :: k

   call set_rock()
   do k = 1, size(distances)
      write (name, "(f0.0,a)") distances(k), " m"
      call set_well([0.0_rk, 0.0_rk], distances(k))
      call compare(side=.false.)
      call checks%is_true(maxval(row%displacement_error/u) < 50.0_rk .and. &
                          maxval(u)/maxval(row%displacement_error) > 0.4_rk, "u, at most, "//name)
      call checks%is_true(maxval(p)/maxval(row%pressure_error) > 0.4_rk, "p, at most, "//name)
      ! 2 m before a drained side, the image of opposite sign.
      call set_well([2.0_rk - far, 0.0_rk], distances(k))
      call compare(side=.true.)
   end do

   ! A well at the centre of its cell.
   call set_well([0.0_rk, 0.0_rk], 3.0_rk)
   scene%injections(1)%x = 0.0_rk
   scene%injections(1)%y = 0.0_rk
   call add_well_places(scene, problem, [volume], time, row)
   call checks%is_close(maxval(row%pressure_error), 0.0_rk, 1.0e-9_rk, "p, centre")
   call checks%is_close(maxval(row%displacement_error), 0.0_rk, 1.0e-20_rk, "u, centre")
   call checks%finish()

contains

   !> Tight enough that the pressure has come 8 m far at the time.
   subroutine set_rock()
      type(material_t) :: material
      type(fluid_t) :: fluid

      material%young = 2.0e10_rk
      material%poisson = 0.2_rk
      material%biot = 0.7_rk
      material%porosity = 0.05_rk
      material%permeability_xx = 1.0e-17_rk
      material%permeability_yy = 1.0e-17_rk
      fluid%compressibility = 4.0e-10_rk
      fluid%viscosity = 1.0e-3_rk
      problem%model%rock = new_rock(material, fluid)
      solid = problem%model%rock%solid_at(1_ik)
   end subroutine set_rock

   !> A cell around a point, its well next to that, and probes at a distance from the well.
   subroutine set_well(centre, distance)
      real(rk), intent(in) :: centre(2), distance  !< [m]
      real(rk), parameter :: size_of_cell = 0.4_rk
      real(rk) :: angle
      integer :: i

      associate (mesh => problem%mesh)
         mesh%n_nodes = 7
         mesh%n_cells = 1
         mesh%xy = reshape([-far, -far, far, -far, far, far, -far, far, &
                            centre + size_of_cell*[-0.5_rk, -1.0_rk/3.0_rk], &
                            centre + size_of_cell*[0.5_rk, -1.0_rk/3.0_rk], &
                            centre + size_of_cell*[0.0_rk, 2.0_rk/3.0_rk]], [2, 7])
         mesh%cell_nodes = reshape([5_ik, 6_ik, 7_ik], [3, 1])
      end associate
      problem%rock_cell = [1_ik]
      scene%injections = [injection_t(x=centre(1) + shift(1), y=centre(2) + shift(2))]
      scene%probes = [(probe_t(), i=1, directions)]
      do i = 1, directions
         angle = 2.0_rk*pi*i/directions
         scene%probes(i)%x = scene%injections(1)%x + distance*cos(angle)
         scene%probes(i)%y = scene%injections(1)%y + distance*sin(angle)
      end do
      row%displacement_error = spread(0.0_rk, 1, directions)
      row%pressure_error = spread(0.0_rk, 1, directions)
   end subroutine set_well

   !> Compare stated errors with the exact changes, those of an image in the left side included.
   subroutine compare(side)
      logical, intent(in) :: side
      real(rk) :: at(2), moved(2), well(2)
      integer :: i

      well = [scene%injections(1)%x, scene%injections(1)%y]
      do i = 1, directions
         at = [scene%probes(i)%x, scene%probes(i)%y]
         moved = displacement(at - well) - displacement(at - well + shift)
         p(i) = pressure(norm2(at - well), norm2(at - well + shift))
         if (side) then
            moved = moved - displacement(at - image(well)) + displacement(at - image(well - shift))
            p(i) = p(i) - pressure(norm2(at - image(well)), norm2(at - image(well - shift)))
         end if
         u(i) = norm2(moved)
         p(i) = abs(p(i))
         ! Outside of the body
         if (at(1) < -far) u(i) = 0.0_rk
         if (at(1) < -far) p(i) = 0.0_rk
      end do
      call add_well_places(scene, problem, [volume], time, row)
      call checks%is_true(all(u <= row%displacement_error), "u holds, "//name)
      call checks%is_true(all(p <= row%pressure_error), "p holds, "//name)
   end subroutine compare

   pure function image(xy)
      real(rk), intent(in) :: xy(2)
      real(rk) :: image(2)

      image = [-2.0_rk*far - xy(1), xy(2)]
   end function image

   !> Of the strain nucleus that a volume is without drainage [m].
   pure function displacement(from)
      real(rk), intent(in) :: from(2)  !< [m]
      real(rk) :: displacement(2)

      displacement = solid%biot*volume/(solid%uniaxial_storage() &
                                        *(solid%lame + 2.0_rk*solid%shear)) &
                     *from/(2.0_rk*pi*dot_product(from, from))
   end function displacement

   !> Pressure at one distance from a constant source less that at another one: the integral of its
   !! slope (Simpson's rule) [Pa].
   pure real(rk) function pressure(r, other)
      real(rk), intent(in) :: r, other  !< [m]

      pressure = (other - r)/6.0_rk*(slope(r) + 4.0_rk*slope(0.5_rk*(r + other)) + slope(other))
   end function pressure

   !> By which the pressure of the source falls with the distance [Pa/m].
   pure real(rk) function slope(r)
      real(rk), intent(in) :: r  !< [m]

      associate (rock => problem%model%rock)
         slope = volume/time/(2.0_rk*pi*rock%mobility_at(1_ik)*r) &
                 *exp(-r**2/(4.0_rk*rock%diffusivity_at(1_ik)*time))
      end associate
   end function slope

end program test_twolevel_place_errors
