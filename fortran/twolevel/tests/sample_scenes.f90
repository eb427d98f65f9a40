!> Small scenes with both levels.
module sample_scenes
   use base_errors, only: error_t
   use base_kinds, only: rk
   use base_timers, only: timers_t
   use coarse_state, only: step_report_t
   use sample_bodies, only: porous_body
   use scene_types, only: fracture_t, scene_t
   use twolevel_state, only: two_levels_t
   implicit none(type, external)
   private

   public :: add_fracture, evaluate_initial_state, squeezed_body

contains

   !> Body of 2 m x 2 m of the rock of Paper C, left and lower side on rollers, loaded from the
   !! right and from above.
   pure function squeezed_body(from_right, from_above) result(scene)
      real(rk), intent(in) :: from_right, from_above  !< total stress, compression positive [Pa]
      type(scene_t) :: scene

      scene = porous_body()
      scene%domain%x_max = 2.0_rk
      scene%domain%y_max = 2.0_rk
      scene%sides(1)%displacement_given(1) = .true.
      scene%sides(3)%displacement_given(2) = .true.
      scene%sides(2)%traction(1) = -from_right
      scene%sides(4)%traction(2) = -from_above
      scene%time%end = 3600.0_rk
      scene%time%step = 60.0_rk
      scene%time%smallest_factor = 1.0e-6_rk
      scene%discretization%size_fracture = 0.05_rk
      scene%discretization%size_boundary = 0.4_rk
      scene%discretization%window = 0.3_rk
      scene%growth%intensities = .true.
   end function squeezed_body

   !> A fracture of 1 mm residual aperture through prescribed points.
   pure subroutine add_fracture(scene, name, x, y, friction, dilation)
      type(scene_t), intent(inout) :: scene
      character(len=*), intent(in) :: name
      real(rk), intent(in) :: x(:), y(:)  !< [m]
      real(rk), intent(in) :: friction  !< [-]
      real(rk), intent(in) :: dilation  !< [rad]

      scene%fractures = [scene%fractures, fracture_t(name=name, x=x, y=y, friction=friction, &
                                                     dilation=dilation, aperture=1.0e-3_rk)]
   end subroutine add_fracture

   !> Begin a scene, find its initial state, and evaluate the intensities in this state.
   subroutine evaluate_initial_state(scene, simulation, timers, error)
      type(scene_t), intent(in) :: scene
      type(two_levels_t), intent(inout) :: simulation
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      type(step_report_t) :: report

      call simulation%begin(scene, timers, error)
      if (.not. allocated(error)) call simulation%equilibrate(timers, report, error)
      if (.not. allocated(error)) call simulation%evaluate(timers, error)
   end subroutine evaluate_initial_state

end module sample_scenes
