!> Stress intensity factors of a free tip, by both methods.
module tips_intensity
   use base_errors, only: error_t, raise_error
   use base_kinds, only: ik, rk
   use fine_loads, only: fine_loads_t
   use fine_model, only: fine_model_t
   use tips_displacement, only: displacement_correlation
   use tips_interaction, only: interaction_integral, largest_radius, rosette_size
   use tips_types, only: frame_of_tip, intensity_t, tip_frame_t
   implicit none(type, external)
   private

   public :: tip_intensity

   ! Domains, measured in rosettes where there is room for them.
   real(rk), parameter :: reach = 4.0_rk  !< radius of the larger domain
   real(rk), parameter :: inner_share = 0.6_rk  !< smaller radius over larger one
   real(rk), parameter :: plateau = 0.3_rk  !< share of the radius within which the weight is 1

contains

   !> Displacement correlation, and the interaction integral on two domains.
   subroutine tip_intensity(model, loads, displacement, tip, intensity, error)
      type(fine_model_t), intent(in) :: model
      type(fine_loads_t), intent(in) :: loads  !< those of the solution
      real(rk), intent(in) :: displacement(:, :)  !< (2, n_nodes) [m]
      integer(ik), intent(in) :: tip  !< 1 .. fracture%n_tips
      type(intensity_t), intent(out) :: intensity
      type(error_t), allocatable, intent(out) :: error
      type(tip_frame_t) :: frame
      real(rk) :: size_of_all
      character(len=16) :: number

      if (tip < 1 .or. tip > model%mesh%fracture%n_tips) then
         write (number, "(i0)") tip
         call raise_error(error, "tip_intensity", "the window has no tip number "//trim(number))
         return
      end if
      frame = frame_of_tip(model%mesh, tip)
      intensity%radius = min(largest_radius(model%mesh, frame), &
                             reach*rosette_size(model%mesh, frame))
      intensity%radius_inner = inner_share*intensity%radius
      associate (result => intensity)
         call displacement_correlation(model%mesh, model%elasticity, displacement, frame, &
                                       result%k1_dc, result%k2_dc)
         call interaction_integral(model, loads, displacement, frame, result%radius, plateau, &
                                   result%k1, result%k2)
         call interaction_integral(model, loads, displacement, frame, result%radius_inner, &
                                   plateau, result%k1_inner, result%k2_inner)
         size_of_all = sum(abs([result%k1, result%k2, result%k1_inner, result%k2_inner, &
                                result%k1_dc, result%k2_dc]))
      end associate
      if (.not. size_of_all <= huge(1.0_rk)) then
         call raise_error(error, "tip_intensity", "an intensity is not a finite number")
      end if
   end subroutine tip_intensity

end module tips_intensity
