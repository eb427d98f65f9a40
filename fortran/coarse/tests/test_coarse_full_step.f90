!> The linear step on a full matrix, of faces whose pressures leave it though their own volumes have
!! a small part in them: the step fulfils the equations as they are, where that part is small, where
!! it is not, and where only that of a face's own pressure is. With the factors of other equations,
!! like these or unlike, the step fulfils them too.
program test_coarse_full_step
   use base_kinds, only: ik, rk
   use coarse_full_step, only: find_full_step, full_slopes, kinds_t, reduced_t
   use coarse_slopes, only: slopes_t
   use coarse_stiffness, only: new_stiffness, stiffness_t
   use contact_newton, only: step_quality_t
   use testing_checks, only: checks_t
   implicit none(type, external)

   integer(ik), parameter :: n = 5  !< two faces, two cells of fluid, a flow between them
   type(checks_t) :: checks

   call compare("small", 0.1_rk)
   call compare("large", 1.0e5_rk)
   call compare("small but for the other face's", 1.0_rk, by_other=4.0e4_rk)
   call compare("hardly any storage", 1.0e-10_rk, storage=1.0e-10_rk)
   call checks%finish()

contains

   !> Face pressures p, pressures of fluid f, flow w between: r S p - p + f and the balances
   !! f_1 + w - (S p)_1, f_2 - w - (S p)_2, and f_2 - f_1 + 1e-12 w, each with some residual.
   subroutine compare(name, volume, by_other, storage)
      character(len=*), intent(in) :: name
      real(rk), intent(in) :: volume  !< of a face by its own pressure, S(1, 1)
      real(rk), intent(in), optional :: by_other  !< S(1, 2) over that
      real(rk), intent(in), optional :: storage  !< factor of the fluid's pressure in its balance
      real(rk), parameter :: resistance = 5.0e-5_rk
      type(slopes_t) :: slopes
      type(kinds_t) :: kinds
      type(step_quality_t) :: quality
      type(reduced_t) :: reduced
      real(rk), allocatable :: jacobian(:, :)
      real(rk) :: residual(n), step(n), stored
      real(rk), allocatable :: matrix(:, :)
      type(stiffness_t) :: stiffness
      integer(ik) :: i, k

      matrix = -volume*reshape([1.0_rk, 0.3_rk, 0.3_rk, 1.0_rk], [2, 2])
      if (present(by_other)) then
         matrix(1, 2) = volume*by_other
         matrix(2, 1) = volume*by_other
      end if
      call new_stiffness(matrix, [1_ik, 2_ik], [1.0_rk, 1.0_rk], stiffness)
      slopes%x_of_q = [1_ik, 2_ik]
      slopes%q_per_x = [1.0_rk, 1.0_rk]
      call slopes%clear(n)
      do i = 1, 2
         call slopes%add_force(i, i, resistance)
         call slopes%add(i, i, -1.0_rk)
         call slopes%add(i, i + 2_ik, 1.0_rk)
         call slopes%add_force(i + 2_ik, i, -1.0_rk)
         stored = 1.0_rk
         if (present(storage)) stored = storage
         call slopes%add(i + 2_ik, i + 2_ik, stored)
         call slopes%add(i + 2_ik, 5_ik, real(3 - 2*i, rk))
         call slopes%add(5_ik, i + 2_ik, real(2*i - 3, rk))
      end do
      call slopes%add(5_ik, 5_ik, 1.0e-12_rk)
      kinds%jump = [integer(ik) ::]
      kinds%face = [1_ik, 2_ik]
      kinds%fluid = [3_ik, 4_ik]
      kinds%flow = [5_ik]
      kinds%end_of_flow = [4_ik]
      kinds%is_flow = [.false., .false., .false., .false., .true.]
      kinds%many = 0
      residual = stored*[1.0_rk, -2.0_rk, 1.0_rk, 1.0_rk, 0.5_rk]
      call find_full_step(stiffness, slopes, kinds, residual, 1.0_rk, .true., reduced, step, &
                          quality)
      call checks%is_true(.not. quality%is_singular, name//": there is a step")
      call full_slopes(stiffness, slopes, jacobian)
      ! Rounding: some terms of 1e-16 of the largest.
      call checks%is_close(maxval(abs(matmul(step, jacobian) + residual) &
                                  /maxval(abs(jacobian), dim=1))/maxval(abs(step)), 0.0_rk, &
                           1.0e-14_rk, name//": the equations are fulfilled")
      call checks%is_true(quality%rest <= 1.0e-13_rk, name//": and it says so")
      do i = 1, 3
         ! By 1 %, by .3, and so that the pressure of a fluid has no equation without the face.
         slopes%value = slopes%value*[((1.0_rk + 0.01_rk*sin(7.0_rk*k*i)), k=1, size(slopes%value))]
         if (i == 2) slopes%value(5) = 0.3_rk*slopes%value(5)
         if (i == 3) slopes%value(3) = 0.0_rk
         call find_full_step(stiffness, slopes, kinds, residual, 1.0_rk, .true., reduced, step, &
                             quality)
         call full_slopes(stiffness, slopes, jacobian)
         call checks%is_close(maxval(abs(matmul(step, jacobian) + residual)), 0.0_rk, 1.0e-11_rk &
                              + 1.0e-14_rk*maxval(abs(jacobian))*maxval(abs(step)), &
                              name//": with earlier factors")
         call checks%is_true(quality%rest <= 1.0e-11_rk, name//": and what remains is stated")
         call checks%is_true(quality%condition*quality%rest <= 2.0e-5_rk, &
                             name//": and moves the solution by little")
      end do
   end subroutine compare

end program test_coarse_full_step
