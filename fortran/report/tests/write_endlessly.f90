!> Writes a table and a VTU file over and over, until it is killed (see check_killed_writer.py).
program write_endlessly
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use report_files, only: make_directory
   use report_series, only: series_t
   use report_vtu, only: vtk_vertex, vtu_grid_t
   implicit none(type, external)

   integer(ik), parameter :: n_points = 20000
   type(error_t), allocatable :: error
   type(series_t) :: table
   type(vtu_grid_t) :: grid
   real(rk) :: xy(2, n_points)
   integer(ik) :: i, vertices(1, n_points)

   do i = 1, n_points
      xy(:, i) = real(i, rk)
      vertices(1, i) = i
   end do
   call make_directory("write_endlessly.out", error)
   do
      call grid%begin(xy, vertices, vtk_vertex, 0.0_rk)
      call grid%add("x", xy(1, :))
      do i = 1, 50  ! most of the time goes into this file
         if (.not. allocated(error)) call grid%write("write_endlessly.out/grid.vtu", error)
      end do
      if (.not. allocated(error)) then
         call table%open("write_endlessly.out/table.csv", ["x_m", "y_m"], [.true., .true.])
         do i = 1, n_points
            call table%put("x_m", xy(1, i))
            call table%put("y_m", xy(2, i))
            call table%end_row()
         end do
         call table%flush(error)
      end if
      if (allocated(error)) error stop 1
   end do
end program write_endlessly
