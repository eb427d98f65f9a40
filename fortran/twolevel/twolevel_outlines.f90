!> Lets the coarse mesh follow the outlines of regions.
module twolevel_outlines
   use base_kinds, only: ik, rk
   use mesh_builder, only: mesh_spec_t
   use scene_region_outline, only: region_outline
   use scene_types, only: domain_t, region_t
   implicit none(type, external)
   private

   public :: follow_outlines

contains

   !> Make the outlines of all regions guides of the mesh, closed lines. The last region, which
   !! counts most, comes first: where there is no room for all, the first have it.
   pure subroutine follow_outlines(regions, domain, spec)
      type(region_t), intent(in) :: regions(:)
      type(domain_t), intent(in) :: domain
      type(mesh_spec_t), intent(inout) :: spec
      real(rk), allocatable :: corners(:, :)
      integer :: i

      allocate (spec%guide_count(0), spec%guides(2, 0))
      do i = size(regions), 1, -1
         corners = region_outline(regions(i), domain)
         spec%guide_count = [spec%guide_count, size(corners, 2, kind=ik) + 1_ik]
         spec%guides = reshape([spec%guides, corners, corners(:, 1)], &
                               [2, size(spec%guides, 2) + size(corners, 2) + 1])
      end do
   end subroutine follow_outlines

end module twolevel_outlines
