!> Input and results of the procedures for a tip in this component.
module fine_tip_types
   use base_kinds, only: ik, rk
   use fine_elasticity, only: elasticity_t, rocks_t
   use fine_mesh, only: fine_mesh_t
   implicit none(type, external)
   private

   public :: complete_errors, frame_of_tip, intensity_t, tip_frame_t

   !> Stress intensity factors of a tip [Pa m^1/2]. k1 > 0 opens; k2 > 0 where the shear stress
   !! ahead of the tip is positive in the tip's own axes (x ahead, y to its left).
   type :: intensity_t
      real(rk) :: k1 = 0.0_rk, k2 = 0.0_rk  !< interaction integral, larger domain
      real(rk) :: k1_inner = 0.0_rk, k2_inner = 0.0_rk  !< interaction integral, smaller domain
      real(rk) :: k1_dc = 0.0_rk, k2_dc = 0.0_rk  !< displacement correlation
      real(rk) :: radius = 0.0_rk, radius_inner = 0.0_rk  !< of the two domains [m]
      real(rk) :: g_domain = 0.0_rk  !< energy release rate by the J-integral [J/m2]
      real(rk) :: k1_error = 0.0_rk, k2_error = 0.0_rk  !< estimates for k1 and k2
      !> What of these follows from layers of the rock's pressure, and passes as they spread
      real(rk) :: passing_error = 0.0_rk
      !> k1 and k2 with what they lack (fine_error), where that is known
      real(rk) :: k1_corrected = 0.0_rk, k2_corrected = 0.0_rk
      real(rk) :: k1_dc_error = 0.0_rk, k2_dc_error = 0.0_rk  !< estimates for k1_dc and k2_dc
      real(rk) :: g_error = 0.0_rk  !< estimate for g_domain [J/m2]
      logical :: closed = .false.  !< the faces touch at the tip: k1 follows from the slip
   end type intensity_t

   !> A free tip with its own axes.
   type :: tip_frame_t
      real(rk) :: origin(2)  !< [m]
      real(rk) :: axes(2, 2)  !< unit vectors in rows: ahead, to its left; axes*v is v there
      real(rk) :: upper  !< +1 if side - is the upper one in these axes (end 2), else -1
      integer(ik) :: node  !< mesh node
      integer(ik) :: cell  !< one of the elements there
      type(elasticity_t) :: rock  !< of that: integrals must not leave it
      integer(ik) :: fracture  !< index in the network
      integer(ik) :: face  !< fracture cell that ends at the tip
   end type tip_frame_t

contains

   !> The axes of a free tip.
   pure function frame_of_tip(mesh, rocks, tip) result(frame)
      type(fine_mesh_t), intent(in) :: mesh
      type(rocks_t), intent(in) :: rocks
      integer(ik), intent(in) :: tip  !< 1 .. fracture%n_tips
      type(tip_frame_t) :: frame

      associate (fracture => mesh%fracture)
         frame%node = fracture%tip_node(tip)
         frame%fracture = fracture%tip_fracture(tip)
         frame%face = fracture%point_cells%at(fracture%tip_point(tip), 1_ik)
         frame%cell = mesh%face_cells(1, frame%face)
         frame%rock = rocks%in_cell(frame%cell)
         frame%origin = mesh%xy(:, frame%node)
         frame%axes(1, :) = fracture%tip_direction(:, tip)
         frame%axes(2, :) = [-frame%axes(1, 2), frame%axes(1, 1)]
         frame%upper = merge(1.0_rk, -1.0_rk, fracture%tip_end(tip) == 2)
      end associate
   end function frame_of_tip

   !> Errors of the other two methods, by their distance from the first and its error.
   elemental subroutine complete_errors(crack_modulus, intensity)
      real(rk), intent(in) :: crack_modulus  !< E' [Pa]
      type(intensity_t), intent(inout) :: intensity

      associate (k1 => intensity%k1_corrected, k2 => intensity%k2_corrected)
         intensity%k1_dc_error = abs(intensity%k1_dc - k1) + intensity%k1_error
         intensity%k2_dc_error = abs(intensity%k2_dc - k2) + intensity%k2_error
         intensity%g_error = abs(intensity%g_domain - (k1**2 + k2**2)/crack_modulus) &
                             + 2.0_rk*(abs(k1)*intensity%k1_error + abs(k2)*intensity%k2_error) &
                             /crack_modulus
      end associate
   end subroutine complete_errors

end module fine_tip_types
