!> Slip events in an archive (base_archive).
submodule(report_slip) report_slip_archive
   use, intrinsic :: iso_c_binding, only: c_loc
   use base_kinds, only: lk
   implicit none(type, external)

contains

   module procedure visit
   integer(lk) :: i, n

   call archive%item("breadth", self%breadth)
   call archive%item("least_slip", self%least_slip)
   call archive%item("seismic_rate", self%seismic_rate)
   call archive%item("n", self%n)
   call archive%extent("news", self%news, n)
   if (archive%is_loading) then
      if (allocated(self%news)) deallocate (self%news)
      if (n >= 0_lk) allocate (self%news(n))
   end if
   if (n > 0_lk) call archive%plain("news", c_loc(self%news), n*storage_size(self%news)/8_lk)
   call archive%extent("live", self%live, n)
   if (archive%is_loading) then
      if (allocated(self%live)) deallocate (self%live)
      if (n >= 0_lk) allocate (self%live(n))
   end if
   do i = 1_lk, n
      associate (live => self%live(i))
         call archive%item("has_begun", live%has_begun)
         call archive%plain("event", c_loc(live%event), storage_size(live%event)/8_lk)
         call archive%plain("before", c_loc(live%before), storage_size(live%before)/8_lk)
         call archive%plain("now", c_loc(live%now), storage_size(live%now)/8_lk)
         call visit_shear(archive, live%start)
         call archive%item("steps", live%steps)
      end associate
   end do
   call archive%extent("patch", self%patch, n)
   if (archive%is_loading) then
      if (allocated(self%patch)) deallocate (self%patch)
      if (n >= 0_lk) allocate (self%patch(n))
   end if
   if (n > 0_lk) call archive%plain("patch", c_loc(self%patch), n*storage_size(self%patch)/8_lk)
   call archive%agree("news", [allocated(self%news), allocated(self%live), &
                               allocated(self%patch)])
   call visit_shear(archive, self%last)
   end procedure visit

   subroutine visit_shear(archive, shear)
      type(archive_t), intent(inout) :: archive
      type(shear_t), intent(inout) :: shear

      call archive%set_extent("shear", -1_ik)
      call archive%list("fracture", shear%fracture, "shear ?; 1:fractures")
      call archive%list("s", shear%s, "2, shear ?")
      call archive%list("traction", shear%traction, "shear ?")
      call archive%agree("shear", [allocated(shear%fracture), allocated(shear%s), &
                                   allocated(shear%traction)])
   end subroutine visit_shear

end submodule report_slip_archive
