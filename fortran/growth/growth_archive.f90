!> Growing networks in an archive (base_archive).
module growth_archive
   use, intrinsic :: iso_c_binding, only: c_loc
   use base_archive, only: archive_t
   use base_kinds, only: lk
   use growth_front, only: front_state_t
   use growth_interaction, only: interaction_t, tip_groups_t
   use growth_segment, only: segment_t
   use growth_tip, only: tip_t
   use mesh_archive, only: visit_network
   implicit none(type, external)
   private

   public :: visit_front, visit_groups, visit_interaction, visit_segments, visit_tips

contains

   subroutine visit_front(archive, name, front)
      type(archive_t), intent(inout) :: archive
      character(len=*), intent(in) :: name
      type(front_state_t), intent(inout) :: front

      call archive%enter(name)
      call visit_network(archive, "network", front%network)
      call visit_tips(archive, "tip", front%tip)
      if (archive%is_loading .and. .not. allocated(archive%fault)) then
         if (.not. (allocated(front%tip) .and. allocated(front%network%first))) then
            call archive%set_fault(name)
            return
         end if
         associate (tip => front%tip, n => size(front%network%first) - 1)
            if (any(tip%fracture < 1 .or. tip%fracture > n .or. tip%end < 1 .or. tip%end > 2) &
                .or. any(max(tip%target, tip%path_target) > n)) call archive%set_fault(name)
         end associate
      end if
      call archive%leave()
   end subroutine visit_front

   subroutine visit_tips(archive, name, tip)
      type(archive_t), intent(inout) :: archive
      character(len=*), intent(in) :: name
      type(tip_t), allocatable, intent(inout), target :: tip(:)
      integer(lk) :: n

      call archive%extent(name, tip, n, "tips ?")
      if (archive%is_loading) then
         if (allocated(tip)) deallocate (tip)
         if (n >= 0_lk) allocate (tip(n))
      end if
      if (n > 0_lk) call archive%plain(name, c_loc(tip), n*storage_size(tip)/8_lk)
   end subroutine visit_tips

   subroutine visit_segments(archive, name, segment)
      type(archive_t), intent(inout) :: archive
      character(len=*), intent(in) :: name
      type(segment_t), allocatable, intent(inout), target :: segment(:)
      integer(lk) :: n

      call archive%extent(name, segment, n, "tips ?")
      if (archive%is_loading) then
         if (allocated(segment)) deallocate (segment)
         if (n >= 0_lk) allocate (segment(n))
      end if
      if (n > 0_lk) call archive%plain(name, c_loc(segment), n*storage_size(segment)/8_lk)
   end subroutine visit_segments

   subroutine visit_interaction(archive, name, interaction)
      type(archive_t), intent(inout) :: archive
      character(len=*), intent(in) :: name
      type(interaction_t), intent(inout) :: interaction

      call archive%enter(name)
      call archive%list("measured", interaction%measured, "tips, tips ?")
      call archive%list("matrix", interaction%matrix, "tips, tips ?")
      call archive%list("is_known", interaction%is_known, "tips ?")
      call archive%list("known_at", interaction%known_at, "tips ?")
      call archive%leave()
   end subroutine visit_interaction

   subroutine visit_groups(archive, name, groups)
      type(archive_t), intent(inout) :: archive
      character(len=*), intent(in) :: name
      type(tip_groups_t), intent(inout) :: groups

      call archive%enter(name)
      call archive%list("kind", groups%kind, "tips ?")
      call archive%list("usual", groups%usual, "tips ?")
      call archive%list("is_alone", groups%is_alone, "tips ?")
      call archive%leave()
   end subroutine visit_groups

end module growth_archive
