!> Tests of report_snapshots: times rise from file to file, whichever way the states go.
program test_report_pvd
   use base_errors, only: error_t
   use base_kinds, only: rk
   use report_files, only: make_directory
   use report_snapshots, only: collection_t
   use testing_checks, only: checks_t
   use testing_files, only: file_text
   implicit none(type, external)

   character(len=*), parameter :: folder = "test_report_pvd.out"
   !> Times that are read back from text, of which the second two are equal [s].
   real(rk), parameter :: rising(4) = [0.0_rk, 2.5_rk, 2.5_rk, 1000.0_rk]
   character(len=*), parameter :: names(4) = ["a.vtu", "b.vtu", "c.vtu", "d.vtu"]
   type(checks_t) :: checks
   type(error_t), allocatable :: error

   call make_directory(folder, error)
   call write_and_read("rising", 1, [1, 2, 3, 4])
   call write_and_read("falling", -1, [4, 3, 2, 1])
   call checks%finish()

contains

   !> A collection lists its files in the given order, each at its time or the number next to it.
   subroutine write_and_read(name, way, order)
      character(len=*), intent(in) :: name
      integer, intent(in) :: way  !< of the times, 1 or -1
      integer, intent(in) :: order(4)
      type(collection_t) :: collection
      character(len=:), allocatable :: text
      real(rk) :: expected, time
      integer :: at, before, k

      call collection%open(folder//"/"//name//".pvd", is_falling=way < 0)
      do k = 1, 4
         call collection%add(way*rising(k), names(k))
         call collection%flush(error)
         call checks%no_error(error, name)
      end do
      text = file_text(folder//"/"//name//".pvd")
      before = 0
      do k = 1, 4
         expected = way*rising(order(k))
         if (order(k) == 3) expected = nearest(expected, real(way, rk))
         at = before + index(text(before + 1:), 'timestep="') + 9
         read (text(at + 1:at + index(text(at + 1:), '"') - 1), *) time
         call checks%is_close(time, expected, 0.0_rk, name//" times")
         before = at + index(text(at:), 'file="'//names(order(k))//'"') - 1
         call checks%is_true(before >= at .and. before < at + 60, name//": the file of the time")
      end do
      call checks%is_true(index(text(before + 1:), "timestep") == 0, name//": no other files")
   end subroutine write_and_read

end program test_report_pvd
