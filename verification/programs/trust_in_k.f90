!> Stated errors of stress intensity factors from windows against known ones (verification/
!! trust_in_k). The fluid of these scenes keeps its pressure, and the rock is hardly porous: the
!! same body without a fluid, with that pressure on its faces, has the same K, found there on
!! adaptive meshes of the whole body without coarse level or windows.
!!
!! First argument: `fitted` for the arrangements below and as many that are drawn, with which a
!! safety factor was chosen, `unseen` for others that were drawn after that. Second argument:
!! `body` to hold the windows against the whole body, `edges` to do without, as in bodies with many
!! fracture cells.
!!
!! Writes values.csv, a row for each K_I and K_II that is not zero, and summary.csv.
program trust_in_k
   use, intrinsic :: iso_fortran_env, only: int64
   use base_kinds, only: degree => radians, ik, rk
   use mechanics_simulation, only: mechanics_simulation_t
   use twolevel_state, only: two_levels_t
   use verification_files, only: finish, table_t, text_argument
   use verification_intensities, only: between, group, open_scene, run_to_intensities, side, &
                                       start_draw, write_faces, write_rock
   implicit none(type, external)

   real(rk), parameter :: length = 0.1_rk  !< of a crack [m]
   real(rk), parameter :: nothing = 1.0_rk  !< K that stays out [Pa m^1/2]

   !> One or two cracks in a square body under -20 and -10 MPa.
   type :: arrangement_t
      real(rk) :: deg  !< direction of the first crack
      real(rk) :: poisson  !< [-]
      integer(ik) :: cells  !< of the coarse level per crack
      real(rk) :: window  !< its edge in lengths of a crack [-]
      real(rk) :: pressure  !< of the fluid [MPa]
      real(rk) :: friction  !< [-]
      real(rk) :: gap = 0.0_rk  !< between the right tip and the right side [m]; 0: in the middle
      real(rk) :: deg_2 = 0.0_rk  !< direction of the second crack
      real(rk) :: away(2) = 0.0_rk  !< its centre from that of the first [m]; 0: there is none
   end type arrangement_t

   real(rk), parameter :: near = 0.25_rk*length
   type(arrangement_t), parameter :: arrangements(*) = [ &
                                     arrangement_t(20.0_rk, 0.20_rk, 10, 5.0_rk, 9.0_rk, 0.4_rk), &
                                     arrangement_t(30.0_rk, 0.10_rk, 20, 2.0_rk, 6.8_rk, 0.5_rk), &
                                     arrangement_t(35.0_rk, 0.30_rk, 5, 5.0_rk, 6.8_rk, 0.5_rk), &
                                     arrangement_t(40.0_rk, 0.45_rk, 10, 1.0_rk, 6.8_rk, 0.5_rk), &
                                     arrangement_t(45.0_rk, 0.20_rk, 10, 5.0_rk, 6.8_rk, 0.5_rk), &
                                     arrangement_t(45.0_rk, 0.20_rk, 40, 5.0_rk, 6.8_rk, 0.5_rk), &
                                     arrangement_t(50.0_rk, 0.10_rk, 20, 1.0_rk, 6.8_rk, 0.5_rk), &
                                     arrangement_t(55.0_rk, 0.30_rk, 10, 2.0_rk, 9.0_rk, 0.4_rk), &
                                     arrangement_t(60.0_rk, 0.20_rk, 5, 2.0_rk, 9.0_rk, 0.4_rk), &
                                     arrangement_t(45.0_rk, 0.20_rk, 10, 10.0_rk, 6.8_rk, 0.5_rk), &
                                     arrangement_t(20.0_rk, 0.20_rk, 10, 5.0_rk, 24.0_rk, 0.5_rk), &
                                     arrangement_t(30.0_rk, 0.10_rk, 20, 2.0_rk, 24.0_rk, 0.5_rk), &
                                     arrangement_t(45.0_rk, 0.20_rk, 5, 5.0_rk, 24.0_rk, 0.5_rk), &
                                     arrangement_t(45.0_rk, 0.30_rk, 40, 1.0_rk, 24.0_rk, 0.5_rk), &
                                     arrangement_t(60.0_rk, 0.45_rk, 10, 1.0_rk, 24.0_rk, 0.5_rk), &
                                    arrangement_t(70.0_rk, 0.20_rk, 10, 10.0_rk, 24.0_rk, 0.5_rk), &
                                     arrangement_t(70.0_rk, 0.30_rk, 20, 2.0_rk, 24.0_rk, 0.5_rk), &
                                     arrangement_t(50.0_rk, 0.10_rk, 5, 1.0_rk, 24.0_rk, 0.5_rk), &
                                arrangement_t(20.0_rk, 0.20_rk, 10, 2.0_rk, 9.5_rk, 0.3_rk, near), &
                                arrangement_t(45.0_rk, 0.30_rk, 20, 5.0_rk, 6.8_rk, 0.5_rk, near), &
                               arrangement_t(30.0_rk, 0.20_rk, 10, 1.0_rk, 24.0_rk, 0.5_rk, near), &
                               arrangement_t(60.0_rk, 0.10_rk, 10, 2.0_rk, 24.0_rk, 0.5_rk, near), &
                                arrangement_t(0.0_rk, 0.20_rk, 10, 2.0_rk, 24.0_rk, 0.5_rk, near), &
                                arrangement_t(45.0_rk, 0.20_rk, 5, 5.0_rk, 24.0_rk, 0.5_rk, near), &
                      arrangement_t(45.0_rk, 0.20_rk, 10, 1.0_rk, 6.8_rk, 0.4_rk, 0.0_rk, 45.0_rk, &
                                                   [0.12_rk, 0.0_rk]), &
                      arrangement_t(45.0_rk, 0.20_rk, 20, 1.0_rk, 6.8_rk, 0.4_rk, 0.0_rk, 30.0_rk, &
                                                   [0.05_rk, 0.06_rk]), &
                     arrangement_t(30.0_rk, 0.30_rk, 10, 2.0_rk, 24.0_rk, 0.4_rk, 0.0_rk, 60.0_rk, &
                                                   [0.1_rk, 0.05_rk]), &
                       arrangement_t(0.0_rk, 0.20_rk, 10, 1.0_rk, 24.0_rk, 0.4_rk, 0.0_rk, 0.0_rk, &
                                                   [0.0_rk, 0.05_rk]), &
                       arrangement_t(0.0_rk, 0.20_rk, 20, 1.0_rk, 24.0_rk, 0.4_rk, 0.0_rk, 0.0_rk, &
                                                   [0.12_rk, 0.02_rk]), &
                      arrangement_t(45.0_rk, 0.20_rk, 5, 5.0_rk, 24.0_rk, 0.4_rk, 0.0_rk, 45.0_rk, &
                                                   [0.12_rk, 0.0_rk]), &
                      arrangement_t(60.0_rk, 0.10_rk, 10, 2.0_rk, 9.0_rk, 0.4_rk, 0.0_rk, 45.0_rk, &
                                                   [0.0_rk, 0.08_rk])]

   real(rk), allocatable :: values(:, :)
   type(table_t) :: table
   integer(ik), parameter :: n = size(arrangements, kind=ik)
   integer(ik) :: i

   allocate (values(8, 0))
   call table%open("values.csv", "arrangement,tip,mode,reference,found,corrected,stated,"// &
                   "of_window,error,error_corrected,scale")
   if (text_argument(1) == "fitted") then
      do i = 1, n
         call compare(arrangements(i))
      end do
   else
      call start_draw(987654_int64)
   end if
   do i = n + 1, 2*n
      call compare(random_arrangement())
   end do
   call table%close()
   call summarize()
   call finish()

contains

   !> One crack in the middle or near a side, or two, closed and slipping or open.
   function random_arrangement() result(drawn)
      type(arrangement_t) :: drawn
      integer(ik), parameter :: cells(4) = [5_ik, 10_ik, 20_ik, 40_ik]
      real(rk), parameter :: windows(6) = [1.0_rk, 1.5_rk, 2.0_rk, 3.0_rk, 5.0_rk, 10.0_rk]
      real(rk) :: around, normal, shear

      drawn%deg = between(20.0_rk, 70.0_rk)
      drawn%poisson = between(0.1_rk, 0.45_rk)
      drawn%cells = cells(1 + int(between(0.0_rk, 3.999_rk)))
      drawn%window = windows(1 + int(between(0.0_rk, 5.999_rk)))
      drawn%friction = between(0.2_rk, 0.5_rk)
      normal = 10.0_rk*(1.0_rk + sin(drawn%deg*degree)**2)  ! on the crack [MPa]
      shear = 5.0_rk*sin(2.0_rk*drawn%deg*degree)
      drawn%pressure = normal + between(1.0_rk, 8.0_rk)
      if (between(0.0_rk, 1.0_rk) < 0.5_rk) then
         drawn%pressure = max(0.0_rk, normal - between(0.2_rk, 0.8_rk)*shear/drawn%friction)
      end if
      around = between(0.0_rk, 3.0_rk)
      if (around < 1.0_rk) then
         drawn%gap = between(0.2_rk, 1.0_rk)*length
      else if (around < 2.0_rk) then
         do
            drawn%deg_2 = drawn%deg + between(-10.0_rk, 10.0_rk)
            around = between(0.0_rk, 360.0_rk)*degree
            drawn%away = between(0.6_rk, 1.5_rk)*length*[cos(around), sin(around)]
            if (distance(drawn) > 0.35_rk*length) exit
         end do
      end if
   end function random_arrangement

   !> The distance between two cracks, from points along them [m].
   pure function distance(arrangement)
      type(arrangement_t), intent(in) :: arrangement
      real(rk) :: distance
      integer, parameter :: n = 20
      real(rk) :: first(2), second(2)
      integer :: j, k

      distance = huge(1.0_rk)
      associate (a => arrangement%deg*degree, b => arrangement%deg_2*degree)
         do j = -n, n
            first = 0.5_rk*length*j/n*[cos(a), sin(a)]
            do k = -n, n
               second = arrangement%away + 0.5_rk*length*k/n*[cos(b), sin(b)]
               distance = min(distance, norm2(second - first))
            end do
         end do
      end associate
   end function distance

   !> Both simulations of an arrangement.
   subroutine compare(arrangement)
      type(arrangement_t), intent(in) :: arrangement
      type(two_levels_t), allocatable :: levels
      type(mechanics_simulation_t), allocatable :: body
      integer(ik) :: tip

      allocate (levels, body)
      if (text_argument(2) == "edges") levels%reference_most = 0
      call write_scene("fluid.nml", arrangement, .true.)
      call run_to_intensities("fluid.nml", levels)
      call write_scene("solid.nml", arrangement, .false.)
      call run_to_intensities("solid.nml", body)
      do tip = 1, size(levels%tip, kind=ik)
         associate (found => levels%tip(tip)%intensity, known => body%tip(tip)%intensity, &
                    window => levels%now%windows%tip(tip)%found)
            call note(tip, 1_ik, known%k1, found%k1, found%k1_corrected, found%k1_error, &
                      window%k1_error, hypot(known%k1, known%k2))
            call note(tip, 2_ik, known%k2, found%k2, found%k2_corrected, found%k2_error, &
                      window%k2_error, hypot(known%k1, known%k2))
         end associate
      end do
   end subroutine compare

   !> The scene's file, with or without a fluid.
   subroutine write_scene(path, arrangement, has_fluid)
      character(len=*), intent(in) :: path
      type(arrangement_t), intent(in) :: arrangement
      logical, intent(in) :: has_fluid
      real(rk) :: centre(2)
      integer :: unit

      call open_scene(path, unit)
      centre = 0.5_rk*(side - arrangement%away)
      if (arrangement%gap > 0.0_rk) then
         centre(1) = side - arrangement%gap - 0.5_rk*length*cos(arrangement%deg*degree)
      end if
      call write_crack(unit, "f1", centre, arrangement%deg, arrangement, has_fluid)
      if (norm2(arrangement%away) > 0.0_rk) then
         call write_crack(unit, "f2", centre + arrangement%away, arrangement%deg_2, arrangement, &
                          has_fluid)
      end if
      call write_rock(unit, arrangement%poisson, arrangement%pressure, has_fluid)
      if (has_fluid) then
         write (unit, group) "&coarse size_fracture = ", length/arrangement%cells, &
            ", size_boundary = 0.2 /"
         write (unit, group) "&fine window = ", arrangement%window*length, ", size_ratio = 0.5 /"
      else
         write (unit, group) "&fe size_fracture = ", length/40, ", size_boundary = 0.2 /"
         write (unit, group) "&adaptive enabled = .true., tolerance = 0.002, passes = 4 /"
      end if
      close (unit)
   end subroutine write_scene

   !> A fracture of the scene's file.
   subroutine write_crack(unit, name, centre, deg, arrangement, has_fluid)
      integer, intent(in) :: unit
      character(len=*), intent(in) :: name
      real(rk), intent(in) :: centre(2)  !< [m]
      real(rk), intent(in) :: deg
      type(arrangement_t), intent(in) :: arrangement
      logical, intent(in) :: has_fluid
      real(rk) :: half(2)

      half = 0.5_rk*length*[cos(deg*degree), sin(deg*degree)]
      write (unit, group) "&fracture name = '", name, "', friction = ", arrangement%friction
      write (unit, group) "  x = ", centre(1) - half(1), ", ", centre(1) + half(1)
      write (unit, group) "  y = ", centre(2) - half(2), ", ", centre(2) + half(2)
      call write_faces(unit, arrangement%pressure, has_fluid)
   end subroutine write_crack

   !> One value, unless it is zero: a closed tip has no K_I.
   subroutine note(tip, mode, known, found, corrected, stated, of_window, scale)
      integer(ik), intent(in) :: tip, mode
      real(rk), intent(in) :: known, found, corrected  !< [Pa m^1/2]
      real(rk), intent(in) :: stated, of_window  !< errors [Pa m^1/2]
      real(rk), intent(in) :: scale  !< magnitude of both modes [Pa m^1/2]

      if (abs(known) <= nothing) return
      call table%row([real([i, tip, mode], rk), known, found, corrected, stated, of_window, &
                      abs(found - known), abs(corrected - known), scale])
      values = reshape([values, abs(found - known), abs(corrected - known), stated, of_window, &
                        scale, real([i, tip, mode], rk)], [8, size(values, 2) + 1])
   end subroutine note

   !> Shares that hold, medians of stated over true errors, means of the errors.
   subroutine summarize()
      real(rk) :: n

      n = real(size(values, 2), rk)
    call table%open("summary.csv", "values,share,share_of_window,share_corrected,median_factor,"// &
                      "median_factor_of_window,mean_error,mean_error_corrected,largest_error")
      associate (error => values(1, :), corrected => values(2, :), stated => values(3, :), &
                 of_window => values(4, :), scale => values(5, :))
         call table%row([n, count(error <= stated)/n, count(error <= of_window)/n, &
                         count(corrected <= stated)/n, median(stated/error), &
                         median(of_window/error), sum(error/scale)/n, sum(corrected/scale)/n, &
                         maxval(error/scale)])
      end associate
      call table%close()
   end subroutine summarize

   !> As many numbers are smaller as are larger.
   pure function median(numbers)
      real(rk), intent(in) :: numbers(:)
      real(rk) :: median
      integer :: k

      median = 0.0_rk
      do k = 1, size(numbers)
         if (count(numbers < numbers(k)) <= size(numbers)/2 .and. &
             count(numbers > numbers(k)) <= size(numbers)/2) median = numbers(k)
      end do
   end function median

end program trust_in_k
