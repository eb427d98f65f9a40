!> Element sizes and rock of a window: elements as small as its tips require, larger away from the
!! tips.
module twolevel_window_spec
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_plane, only: norm2
   use coarse_rock, only: new_rock, rock_t
   use fine_elasticity, only: elasticity_t
   use growth_network, only: end_pieces
   use mesh_builder, only: corner_share, mesh_spec_t
   use mesh_types, only: network_t
   use report_corners, only: kinks_of_scene
   use report_scene, only: follow_outlines, keep_off, regions_of_other_rock
   use scene_types, only: material_t, scene_t
   use twolevel_window_tip, only: window_tip_t
   implicit none(type, external)
   private

   public :: constants_of_rock, focus, grow_away, tip_place, window_spec

   !> Growth of element size with distance from the fractures, on average [-]
   real(rk), parameter :: grading = 0.4_rk

   !> Growth of element size along fractures with the distance from the tips served, up to the size
   !! of coarse fracture cells, below which the pressure of the fluid is not resolved; and, where
   !! the errors are compared with the whole body (twolevel_coarse_errors), growth around the
   !! rosettes beyond three radii, the range of the interaction integrals; and with fronts of
   !! temperature, which are not smooth where the intensities are [-].
   real(rk), parameter :: along = 0.4_rk, around = 0.5_rk, in_fronts = 0.15_rk

contains

   !> Specification of a rectangle with elements of one size along fractures.
   pure function window_spec(lower, upper, element_size, scene) result(spec)
      real(rk), intent(in) :: lower(2), upper(2)  !< corners [m]
      real(rk), intent(in) :: element_size  !< element size at the fractures [m]
      type(scene_t), intent(in) :: scene
      type(mesh_spec_t) :: spec

      spec%x_min = lower(1)
      spec%y_min = lower(2)
      spec%x_max = upper(1)
      spec%y_max = upper(2)
      spec%size_fracture = element_size
      spec%size_boundary = element_size + grading*norm2(upper - lower)/2.0_rk
      spec%is_window = .true.
      spec%is_rough = .true.
      spec%rosette_sectors = scene%discretization%rosette_sectors
      spec%rosette_radius = element_size
      spec%joint_size = corner_share*element_size
      call spec%refine(kinks_of_scene(scene), spec%joint_size)
   end function window_spec

   !> Let elements grow around the rosettes.
   pure subroutine grow_away(spec, has_fronts, is_compared)
      type(mesh_spec_t), intent(inout) :: spec
      logical, intent(in) :: has_fronts  !< temperatures may come in from sides
      logical, intent(in) :: is_compared  !< with the body

      if (is_compared) spec%ring_slope = around
      if (has_fronts) spec%ring_slope = in_fronts
   end subroutine grow_away

   !> Set elements and rosettes as the tips served require, and the outlines of regions of other
   !! rock.
   subroutine focus(scene, network, tips, serves, has_focus, spec, error)
      type(scene_t), intent(in) :: scene
      type(network_t), intent(in) :: network
      type(window_tip_t), intent(in) :: tips(:)  !< (tips of the network)
      integer(ik), intent(in) :: serves(:)  !< numbers of the tips served
      !> (tips served) the elements around others are as large as coarse cells
      logical, intent(in) :: has_focus(:)
      type(mesh_spec_t), intent(inout) :: spec
      type(error_t), allocatable, intent(out) :: error
      real(rk), allocatable :: piece(:, :)
      integer(ik), allocatable :: foci(:)
      integer(ik) :: i

      foci = pack(serves, has_focus)
      if (size(foci) == 0) foci = serves(:1)
      spec%focus_slope = along
      spec%focus_size = max(spec%size_fracture, scene%discretization%size_fracture)
      spec%foci = reshape([(tip_place(network, tips(foci(i))), i=1, size(foci))], [2, size(foci)])
      piece = end_pieces(network)
      spec%end_radius = spread(spread(0.0_rk, 1, 2), 2, size(piece, 2))
      if (any(scene%fractures%cell_size > 0.0_rk)) then
         spec%own_size = [(scene%cell_size_of(i), i=1, size(scene%fractures, kind=ik))]
         do i = 1, size(tips, kind=ik)
            associate (tip => tips(i))
               spec%end_radius(tip%end, tip%fracture) = &
                  tip%rosette_radius(scene, piece(tip%end, tip%fracture))
            end associate
         end do
      end if
      do i = 1, size(serves, kind=ik)
         associate (tip => tips(serves(i)))
            associate (radius => spec%end_radius(tip%end, tip%fracture), &
                       last => piece(tip%end, tip%fracture))
               radius = tip%rosette_radius(scene, last)
               if (.not. has_focus(i)) then
                  radius = max(radius, min(scene%cell_size_of(tip%fracture), 0.5_rk*last))
               end if
               if (.not. allocated(scene%regions)) cycle
               call keep_off(tip_place(network, tip), scene, radius, error)
               if (allocated(error)) return
            end associate
         end associate
      end do
      if (any(regions_of_other_rock(scene))) then
         call follow_outlines(scene%regions, scene%domain, spec)
      end if
   end subroutine focus

   !> Position of a tip [m].
   pure function tip_place(network, tip) result(xy)
      type(network_t), intent(in) :: network
      type(window_tip_t), intent(in) :: tip
      real(rk) :: xy(2)

      associate (first => network%first)
         xy = network%xy(:, merge(first(tip%fracture), first(tip%fracture + 1) - 1, tip%end == 1))
      end associate
   end function tip_place

   !> Elastic constants of a rock, drained or undrained (twolevel_window: set_rock).
   pure type(elasticity_t) function constants_of_rock(material, scene, undrained) result(elasticity)
      type(material_t), intent(in) :: material
      type(scene_t), intent(in) :: scene
      logical, intent(in) :: undrained
      type(rock_t) :: rock
      real(rk) :: lame

      rock = new_rock(material, scene%fluid)
      elasticity = elasticity_t(young=material%young, poisson=material%poisson, &
                                biot=rock%biot(1), plane_stress=material%plane_stress)
      if (undrained) then
         associate (shear => rock%shear(1))
            lame = rock%lame(1) + rock%biot(1)**2/rock%storage(1)
            elasticity%poisson = lame/(2.0_rk*(lame + shear))
            if (material%plane_stress) elasticity%poisson = lame/(lame + 2.0_rk*shear)
            elasticity%young = 2.0_rk*shear*(1.0_rk + elasticity%poisson)
         end associate
      end if
   end function constants_of_rock

end module twolevel_window_spec
