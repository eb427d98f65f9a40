!> Stress intensity factors of one body with a fluid, by windows, and without, by finite elements.
!!
!! The fluid keeps its pressure and the rock is hardly porous: the same body without a fluid, with
!! that pressure on the faces, has the same K.
module verification_intensities
   use, intrinsic :: iso_fortran_env, only: int64
   use base_errors, only: error_t
   use base_kinds, only: rk
   use base_timers, only: timers_t
   use report_simulation, only: simulation_t
   use scene_namelist, only: read_scene
   use scene_types, only: scene_t
   use verification_files, only: stop_on
   implicit none(type, external)
   private

   public :: between, group, open_scene, run_to_intensities, side, start_draw, write_faces
   public :: write_rock

   real(rk), parameter :: side = 2.0_rk  !< of the body [m]
   character(len=*), parameter :: group = "(a,*(g0))"  !< format of lines of a scene's file
   integer(int64) :: seed = 20261122_int64

contains

   !> Draw other numbers.
   subroutine start_draw(new_seed)
      integer(int64), intent(in) :: new_seed

      seed = new_seed
   end subroutine start_draw

   !> A number that looks random, the same on every machine (minimal standard generator).
   real(rk) function between(lower, upper)
      real(rk), intent(in) :: lower, upper

      seed = mod(48271_int64*seed, 2147483647_int64)
      between = lower + (upper - lower)*real(seed, rk)/2147483647.0_rk
   end function between

   !> Begin a scene's file: a square body under -20 and -10 MPa.
   subroutine open_scene(path, unit)
      character(len=*), intent(in) :: path
      integer, intent(out) :: unit

      open (newunit=unit, file=path, status="replace", action="write")
      write (unit, group) "&domain x_min = 0.0, y_min = 0.0, x_max = ", side, ", y_max = ", side, &
         " /"
      write (unit, group) "&side name = 'left', x_displacement = 0.0 /"
      write (unit, group) "&side name = 'bottom', y_displacement = 0.0 /"
      write (unit, group) "&side name = 'right', x_traction = -20.0e6 /"
      write (unit, group) "&side name = 'top', y_traction = -10.0e6 /"
      write (unit, group) "&growth intensities = .true. /"
      write (unit, group) "&output vtu = .false. /"
   end subroutine open_scene

   !> End the group of a fracture.
   subroutine write_faces(unit, pressure, has_fluid)
      integer, intent(in) :: unit
      real(rk), intent(in) :: pressure  !< [MPa]
      logical, intent(in) :: has_fluid

      if (has_fluid) then
         write (unit, group) "  aperture = 1.0e-3 /"
      else
         write (unit, group) "  face_pressure = ", pressure*1.0e6_rk, " /"
      end if
   end subroutine write_faces

   !> Rock, fluid and time, or the load programme.
   subroutine write_rock(unit, poisson, pressure, has_fluid)
      integer, intent(in) :: unit
      real(rk), intent(in) :: poisson, pressure  !< [-], of the fluid [MPa]
      logical, intent(in) :: has_fluid

      write (unit, group) "&material young = 40.0e9, poisson = ", poisson
      if (has_fluid) then
         write (unit, group) "  biot = 1.0e-6, porosity = 1.0e-6, permeability = 1.0e-30 /"
         write (unit, group) "&fluid compressibility = 1.0e-3, viscosity = 1.0e-4 /"
         write (unit, group) "&initial pressure = ", pressure*1.0e6_rk, " /"
         write (unit, group) "&time end = 1.0, step = 1.0 /"
      else
         write (unit, group) " /"
         write (unit, group) "&load from = 0.0, to = 1.0, steps = 1 /"
      end if
   end subroutine write_rock

   !> A scene until its first state with intensities.
   subroutine run_to_intensities(path, simulation)
      character(len=*), intent(in) :: path
      class(simulation_t), intent(inout) :: simulation
      type(scene_t) :: scene
      type(timers_t) :: timers
      type(error_t), allocatable :: error

      call read_scene(path, scene, error)
      call stop_on(error)
      call timers%begin()
      call simulation%begin(scene, timers, error)
      call stop_on(error)
      call simulation%next_state(timers, error)
      call stop_on(error)
      call simulation%grow(timers, error)
      call stop_on(error)
   end subroutine run_to_intensities

end module verification_intensities
